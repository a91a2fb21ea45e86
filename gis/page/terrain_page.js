'use strict';
(function () {
const root = document.documentElement;
const element = id => document.getElementById(id);
const page = JSON.parse(element('page').textContent);
const terrains = page.terrains, two = terrains.length === 2;

function fail(text) {
  element('message').textContent = text;
  element('message').hidden = false;
  root.dataset.state = 'failed';
}

// Heights: 16 bits, the lower byte first; 65535 where void.
function readSteps(id) {
  const bytes = atob(element(id).textContent), steps = new Uint16Array(bytes.length / 2);
  for (let i = 0; i < steps.length; ++i) steps[i] = bytes.charCodeAt(2 * i) | bytes.charCodeAt(2 * i + 1) << 8;
  return steps;
}
const VOID = 65535;

// Metres east and south, the centre of the first terrain at the origin.
function place(t, column, row) {
  const p = t.placement;
  return [p[0] + column * p[1] + row * p[2] - middle[0], p[3] + column * p[4] + row * p[5] - middle[1]];
}
let middle = [0, 0];
middle = place(terrains[0], terrains[0].width / 2, terrains[0].height / 2);

// A vertex per cell at its centre; a square of four valid cells is two triangles, one of three valid cells is one.
function surface(t) {
  const { width, height, steps } = t, count = width * height;
  const position = new Float32Array(3 * count), uv = new Float32Array(2 * count), cell = new Float32Array(2 * count);
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, ++i) {
      const [east, south] = place(t, x + 0.5, y + 0.5);
      position[3 * i] = east;
      position[3 * i + 1] = steps[i] === VOID ? 0 : t.low + steps[i] * t.step - lowest;
      position[3 * i + 2] = south;
      uv[2 * i] = (x + 0.5) * t.pixelsPerCell / t.picture[0];
      uv[2 * i + 1] = 1 - (y + 0.5) * t.pixelsPerCell / t.picture[1];
      cell[2 * i] = x;
      cell[2 * i + 1] = y;
    }
  const index = new Uint32Array(6 * Math.max(0, width - 1) * Math.max(0, height - 1));
  let used = 0;
  const triangle = (a, b, c) => { index[used++] = a; index[used++] = b; index[used++] = c; };
  for (let y = 0; y + 1 < height; ++y)
    for (let x = 0; x + 1 < width; ++x) {
      const a = y * width + x, b = a + 1, c = a + width, d = c + 1;
      const va = steps[a] !== VOID, vb = steps[b] !== VOID, vc = steps[c] !== VOID, vd = steps[d] !== VOID;
      if (va && vb && vc && vd) {
        // Along the diagonal that bends less.
        if (Math.abs(steps[a] - steps[d]) <= Math.abs(steps[b] - steps[c])) { triangle(a, c, d); triangle(a, d, b); }
        else { triangle(a, c, b); triangle(b, c, d); }
      } else if (va && vb && vc) triangle(a, c, b);
      else if (va && vb && vd) triangle(a, d, b);
      else if (va && vc && vd) triangle(a, c, d);
      else if (vb && vc && vd) triangle(b, c, d);
    }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
  geometry.setAttribute('uv', new THREE.BufferAttribute(uv, 2));
  geometry.setAttribute('cell', new THREE.BufferAttribute(cell, 2));
  geometry.setIndex(new THREE.BufferAttribute(index.slice(0, used), 1));
  return geometry;
}

// Walls from the outermost cells down to a floor, so that terrain looks cut from a block, and voids like holes, not like snow.
// `foot`: 1 at the bottom.
function walls(t, top) {
  const { width, height, steps } = t, at = top.attributes.position.array;
  const position = [], foot = [], shade = [];
  const edge = (a, b, light) => {
    if (steps[a] === VOID || steps[b] === VOID) return;
    const corner = (i, f) => { position.push(at[3 * i], at[3 * i + 1], at[3 * i + 2]); foot.push(f); shade.push(light); };
    corner(a, 0); corner(a, 1); corner(b, 0);
    corner(b, 0); corner(a, 1); corner(b, 1);
  };
  for (let x = 0; x + 1 < width; ++x) { edge(x, x + 1, 0.93); edge((height - 1) * width + x, (height - 1) * width + x + 1, 0.86); }
  for (let y = 0; y + 1 < height; ++y) { edge(y * width, (y + 1) * width, 1); edge((y + 1) * width - 1, (y + 2) * width - 1, 0.78); }
  const corners = [0, width - 1, (height - 1) * width, height * width - 1];
  for (const i of [0, 2, 1, 1, 2, 3].map(k => corners[k])) { position.push(at[3 * i], 0, at[3 * i + 2]); foot.push(1); shade.push(0.68); }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(position), 3));
  geometry.setAttribute('foot', new THREE.BufferAttribute(new Float32Array(foot), 1));
  geometry.setAttribute('shade', new THREE.BufferAttribute(new Float32Array(shade), 1));
  return geometry;
}

const vertexShader = `
  uniform float lift, base;
  varying float height;
  #ifdef WALL
  attribute float foot, shade;
  varying float tone;
  #else
  attribute vec2 cell;
  varying vec2 place, pixel;
  #endif
  void main() {
    vec3 p = vec3(position.x, position.y * lift, position.z);
    height = position.y;
  #ifdef WALL
    p.y = mix(p.y, base, foot);
    tone = shade;
  #else
    place = cell;
    pixel = uv;
  #endif
    gl_Position = projectionMatrix * modelViewMatrix * vec4(p, 1.0);
  }`;
const fragmentShader = `
  varying float height;
  #ifdef WALL
  varying float tone;
  void main() { gl_FragColor = vec4(vec3(0.80, 0.775, 0.74) * tone, 1.0); }
  #else
  uniform sampler2D picture;
  uniform float lowest, interval;
  uniform bool contours, grid;
  varying vec2 place, pixel;
  float line(float value, float pixels) {
    float wide = fwidth(value);
    float share = 1.0 - smoothstep(pixels - 0.5, pixels + 0.5, abs(fract(value - 0.5) - 0.5) / max(wide, 1e-6));
    return share * (1.0 - smoothstep(0.15, 0.45, wide));
  }
  void main() {
    vec3 colour = texture2D(picture, pixel).rgb;
    if (contours) {
      float level = (height + lowest) / interval;
      colour = mix(colour, vec3(0.32, 0.20, 0.12), 0.55 * max(line(level, 0.6), line(level / 5.0, 1.1)));
    }
    if (grid) colour = mix(colour, vec3(0.1, 0.12, 0.2), 0.45 * max(line(place.x, 0.5), line(place.y, 0.5)));
    gl_FragColor = vec4(colour, 1.0);
  }
  #endif`;

const common = { lift: { value: 1 }, base: { value: 0 }, lowest: { value: 0 }, interval: { value: 1 }, contours: { value: false }, grid: { value: false } };
let lowest = Infinity, highest = -Infinity, reach = 1;

function scene(t, texture) {
  const side = { side: THREE.DoubleSide, vertexShader, fragmentShader };
  const top = surface(t), result = new THREE.Scene();
  result.add(new THREE.Mesh(top, new THREE.ShaderMaterial({ ...side, uniforms: { ...common, picture: { value: texture } } })));
  result.add(new THREE.Mesh(walls(t, top), new THREE.ShaderMaterial({ ...side, uniforms: common, defines: { WALL: 1 } })));
  result.children.forEach(mesh => { mesh.frustumCulled = false; });
  return result;
}

// 1, 2 or 5 times a power of ten, at most `value`.
function round125(value) {
  const power = Math.pow(10, Math.floor(Math.log10(value)));
  return (value >= 5 * power ? 5 : value >= 2 * power ? 2 : 1) * power;
}
const number = (value, decimals) => value.toLocaleString('en-GB', { minimumFractionDigits: decimals, maximumFractionDigits: decimals });
const metres = value => number(value, highest - lowest >= 20 ? 0 : highest - lowest >= 2 ? 1 : 2) + ' m';
const distance = value => value >= 1000 ? number(value / 1000, 0) + ' km' : String(+value.toPrecision(3)) + ' m';

function start() {
  const canvas = element('view');
  const context = canvas.getContext('webgl2', { alpha: true, antialias: true });
  if (!context) return fail('This page needs WebGL 2, which this browser does not offer, or has switched off.');
  terrains.forEach((t, i) => {
    t.steps = readSteps('heights-' + i);
    let top = -1;
    for (const s of t.steps) if (s !== VOID && s > top) top = s;
    if (top < 0) return;
    lowest = Math.min(lowest, t.low);
    highest = Math.max(highest, t.low + top * t.step);
  });
  if (!(lowest <= highest)) lowest = highest = 0;
  const first = terrains[0];
  const corners = [[0, 0], [first.width, 0], [0, first.height], [first.width, first.height]].map(([x, y]) => place(first, x, y));
  reach = Math.max(...corners.map(([x, y]) => Math.hypot(x, y)), 1e-6);
  common.lowest.value = lowest;
  common.base.value = -0.045 * reach;
  common.interval.value = highest > lowest ? round125((highest - lowest) / 12) : 1;

  const renderer = new THREE.WebGLRenderer({ canvas, context, alpha: true, antialias: true });
  renderer.setClearColor(0, 0);
  const scenes = terrains.map((t, i) => {
    const texture = new THREE.Texture(element('picture-' + i));
    texture.anisotropy = Math.min(4, renderer.capabilities.getMaxAnisotropy());
    texture.generateMipmaps = true;
    texture.minFilter = THREE.LinearMipmapLinearFilter;
    texture.needsUpdate = true;
    return scene(t, texture);
  });
  const camera = new THREE.PerspectiveCamera(30, 1, 1, 10);
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.enableKeys = false;
  controls.maxPolarAngle = 0.495 * Math.PI;
  controls.zoomSpeed = 0.8;
  controls.minDistance = reach / 200;
  controls.maxDistance = reach * 12;

  let split = 0.5, wanted = false;
  const size = () => [canvas.clientWidth || 1, canvas.clientHeight || 1];

  function render() {
    wanted = false;
    const [width, height] = size(), away = camera.position.distanceTo(controls.target);
    camera.near = Math.max(away / 400, (away - 3 * reach) / 2);
    camera.far = away + 4 * reach + (highest - lowest) * common.lift.value;
    camera.updateProjectionMatrix();
    renderer.setScissorTest(two);
    const at = Math.round(width * split);
    if (two) renderer.setScissor(0, 0, at, height);
    renderer.render(scenes[0], camera);
    if (two) {
      renderer.setScissor(at, 0, width - at, height);
      renderer.render(scenes[1], camera);
    }
    showScale(away, height);
    const turn = controls.getAzimuthalAngle();
    element('needle').setAttribute('transform', `rotate(${turn * 180 / Math.PI})`);
    root.dataset.azimuth = turn.toFixed(4);
    root.dataset.distance = away.toFixed(3);
    if (root.dataset.state === 'loading') root.dataset.state = 'ready';
  }
  function draw() {
    if (wanted) return;
    wanted = true;
    requestAnimationFrame(render);
  }

  function showScale(away, height) {
    if (!page.metric) return;
    const perPixel = 2 * away * Math.tan(camera.fov * Math.PI / 360) / height;
    const length = round125(110 * perPixel);
    element('bar').style.width = length / perPixel + 'px';
    element('bar-text').textContent = distance(length) + ' at the centre';
  }

  // From the south, 40 degrees high, so that the whole block is in sight.
  function showAll() {
    const [width, height] = size(), half = camera.fov * Math.PI / 360;
    const away = reach * 0.92 / Math.tan(Math.min(half, Math.atan(Math.tan(half) * width / height)));
    const from = 42 * Math.PI / 180;
    controls.target.set(0, (highest - lowest) * common.lift.value * 0.35 - 0.06 * reach, 0);
    camera.position.set(0, Math.sin(from), Math.cos(from)).multiplyScalar(away).add(controls.target);
    controls.update();
    draw();
  }

  function turn(azimuth, polar, zoom) {
    const arm = new THREE.Spherical().setFromVector3(camera.position.clone().sub(controls.target));
    arm.theta += azimuth;
    arm.phi = Math.min(controls.maxPolarAngle, Math.max(1e-3, arm.phi + polar));
    arm.radius = Math.min(controls.maxDistance, Math.max(controls.minDistance, arm.radius * zoom));
    camera.position.setFromSpherical(arm).add(controls.target);
    controls.update();
    draw();
  }
  function move(right, forward) {
    const away = camera.position.distanceTo(controls.target), a = controls.getAzimuthalAngle();
    const step = new THREE.Vector3(right * Math.cos(a) - forward * Math.sin(a), 0, -right * Math.sin(a) - forward * Math.cos(a)).multiplyScalar(away * 0.06);
    camera.position.add(step);
    controls.target.add(step);
    controls.update();
    draw();
  }
  const northUp = () => turn(-controls.getAzimuthalAngle(), 0, 1);

  // What is under the pointer: walks along the ray until it is below the heights.
  function heightAt(t, east, south) {
    const p = t.placement, x = east + middle[0] - p[0], y = south + middle[1] - p[3], det = p[1] * p[5] - p[2] * p[4];
    const column = (x * p[5] - y * p[2]) / det - 0.5, row = (y * p[1] - x * p[4]) / det - 0.5;
    const c = Math.floor(column), r = Math.floor(row);
    if (c < 0 || r < 0 || c + 1 >= t.width || r + 1 >= t.height) return NaN;
    const u = column - c, v = row - r, i = r * t.width + c, s = t.steps;
    if (s[i] === VOID || s[i + 1] === VOID || s[i + t.width] === VOID || s[i + t.width + 1] === VOID) return NaN;
    return t.low + t.step * ((s[i] * (1 - u) + s[i + 1] * u) * (1 - v) + (s[i + t.width] * (1 - u) + s[i + t.width + 1] * u) * v);
  }
  function readOut(event) {
    const [width, height] = size(), t = terrains[two && event.clientX > width * split ? 1 : 0];
    const ray = new THREE.Raycaster();
    ray.setFromCamera({ x: 2 * event.clientX / width - 1, y: 1 - 2 * event.clientY / height }, camera);
    const { origin, direction } = ray.ray, top = (highest - lowest) * common.lift.value;
    let text = '\u00a0';
    if (direction.y < 0) {
      const begin = Math.max(0, (origin.y - top) / -direction.y), end = origin.y / -direction.y, steps = 1200;
      for (let k = 0; k <= steps; ++k) {
        const at = begin + (end - begin) * k / steps;
        const z = heightAt(t, origin.x + direction.x * at, origin.z + direction.z * at);
        if (!((z - lowest) * common.lift.value >= origin.y + direction.y * at - top * 0.001 - 1e-9)) continue;
        text = metres(z) + ' at the pointer';
        break;
      }
    }
    element('readout').textContent = text;
  }

  // Exaggeration from 0.5 to 20 on a logarithmic slider.
  const lift = element('lift'), liftOf = v => 0.5 * Math.pow(40, v / 100);
  function setLift(value) {
    common.lift.value = value;
    element('lift-text').textContent = '\u00d7 ' + (value < 9.95 ? value.toFixed(1) : value.toFixed(0));
    lift.setAttribute('aria-valuetext', value.toFixed(1) + ' times');
    draw();
  }
  const snap = value => Math.abs(value - Math.round(value)) < 0.04 * value ? Math.round(value) : Math.round(value * 10) / 10;
  lift.addEventListener('input', () => setLift(snap(liftOf(+lift.value))));
  lift.value = 100 * Math.log(page.exaggeration / 0.5) / Math.log(40);

  function setSplit(share) {
    split = Math.min(1, Math.max(0, share));
    element('divider').style.left = 100 * split + '%';
    element('divider').setAttribute('aria-valuenow', Math.round(100 * split));
    draw();
  }

  function resize() {
    const [width, height] = size();
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    draw();
  }

  terrains.forEach((t, i) => {
    const label = element('label-' + i), heading = document.createElement('h1');
    heading.textContent = t.name;
    label.append(heading);
    for (const fact of t.facts) label.append(Object.assign(document.createElement('p'), { textContent: fact }));
    label.classList.toggle('paired', two);
    label.hidden = false;
  });
  if (page.ramp.length > 1) {
    element('ramp').style.background = `linear-gradient(90deg, ${page.ramp.join(',')})`;
    element('ramp-low').textContent = metres(page.low);
    element('ramp-high').textContent = metres(page.high);
    element('legend').hidden = false;
  }
  element('scale').hidden = !page.metric;
  element('interval').textContent = highest > lowest ? `every ${+common.interval.value.toPrecision(3)} m` : '';
  element('divider').hidden = !two;

  controls.addEventListener('change', draw);
  window.addEventListener('resize', resize);
  canvas.addEventListener('contextmenu', event => event.preventDefault());
  canvas.addEventListener('pointermove', event => { if (event.buttons === 0) readOut(event); });
  canvas.addEventListener('webglcontextrestored', draw);
  canvas.addEventListener('keydown', event => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (step && event.shiftKey) move(step[0], step[1]);
    else if (step) turn(step[0] * 0.08, -step[1] * 0.06, 1);
    else if (event.key === '+' || event.key === '=') turn(0, 0, 0.85);
    else if (event.key === '-') turn(0, 0, 1 / 0.85);
    else if (event.key === 'n') northUp();
    else if (event.key === '0' || event.key === 'Home') showAll();
    else return;
    event.preventDefault();
  });
  for (const name of ['contours', 'grid'])
    element(name).addEventListener('change', event => { common[name].value = event.target.checked; draw(); });
  element('reset').addEventListener('click', showAll);
  element('compass').addEventListener('click', northUp);
  element('controls').addEventListener('submit', event => event.preventDefault());
  const divider = element('divider');
  divider.addEventListener('pointerdown', event => { divider.setPointerCapture(event.pointerId); event.preventDefault(); divider.focus(); });
  divider.addEventListener('pointermove', event => { if (divider.hasPointerCapture(event.pointerId)) setSplit(event.clientX / size()[0]); });
  divider.addEventListener('wheel', event => { canvas.dispatchEvent(new WheelEvent('wheel', event)); event.preventDefault(); }, { passive: false });
  divider.addEventListener('keydown', event => {
    const to = { ArrowLeft: split - 0.02, ArrowRight: split + 0.02, Home: 0, End: 1 }[event.key];
    if (to === undefined) return;
    setSplit(to);
    event.preventDefault();
  });

  for (const name of ['contours', 'grid']) common[name].value = element(name).checked;
  setLift(page.exaggeration);
  if (two) setSplit(0.5);
  resize();
  showAll();
  if (highest === lowest && terrains.every(t => t.steps.every(s => s === VOID))) fail('There is no valid cell to show.');
}

// Pictures are decoded before they become textures.
Promise.all(terrains.map((t, i) => element('picture-' + i).decode())).then(start).catch(error => fail('The terrain could not be drawn: ' + error.message));
})();
