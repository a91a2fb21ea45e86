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

// Bytes of a zlib stream in base64.
async function inflate(id) {
  const bytes = Uint8Array.from(atob(element(id).textContent), c => c.charCodeAt(0));
  element(id).remove();
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Steps above the lowest, as pack_heights of gis/page_heights.h describes them.
const VOID = 65535, MAX_STEP = 16385;
function readSteps(bytes, width, height) {
  const count = width * height, steps = new Uint16Array(count), known = new Int32Array(count);
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, ++i) {
      let foretold = (x ? known[i - 1] : 0) + (y ? known[i - width] : 0) - (x && y ? known[i - width - 1] : 0);
      foretold = Math.min(MAX_STEP, Math.max(0, foretold));
      const code = bytes[i] | bytes[count + i] << 8;
      known[i] = code === 0 ? foretold : foretold + (code & 1 ? code >> 1 : -(code >> 1));
      steps[i] = code === 0 ? VOID : known[i];
    }
  return steps;
}

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

// Walls from the rim of the surface, that of its holes too, down to a floor: terrain looks cut from a block, and a void like a hole.
// `foot`: 1 at the bottom.
function walls(t, top) {
  const { width, height, steps } = t, at = top.attributes.position.array;
  const position = [], foot = [], shade = [];
  // One tone along ragged rims, darker below, so that holes look deep; along straight sides of the block its light.
  const wall = (a, b, light) => {
    const corner = (i, f) => { position.push(at[3 * i], at[3 * i + 1], at[3 * i + 2]); foot.push(f); shade.push(light || (f ? 0.56 : 0.8)); };
    corner(a, 0); corner(a, 1); corner(b, 0);
    corner(b, 0); corner(a, 1); corner(b, 1);
  };
  // Whether the block has its four corners: else its sides are rims too.
  const whole = [0, width - 1, (height - 1) * width, height * width - 1].every(i => steps[i] !== VOID);
  const valid = (x, y) => steps[y * width + x] !== VOID ? 1 : 0;
  // Whether triangles lie in the square whose upper left corner is that cell.
  const covered = (x, y) => x >= 0 && y >= 0 && x + 1 < width && y + 1 < height && valid(x, y) + valid(x + 1, y) + valid(x, y + 1) + valid(x + 1, y + 1) >= 3;
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const a = y * width + x, b = a + 1, c = a + width, d = c + 1, here = covered(x, y);
      if (x + 1 < width && valid(x, y) && valid(x + 1, y) && covered(x, y - 1) !== here) wall(a, b, whole && y === 0 ? 0.93 : whole && y + 1 === height ? 0.86 : 0);
      if (y + 1 < height && valid(x, y) && valid(x, y + 1) && covered(x - 1, y) !== here) wall(a, c, whole && x === 0 ? 1 : whole && x + 1 === width ? 0.78 : 0);
      if (!here) continue;
      if (steps[a] === VOID || steps[d] === VOID) wall(b, c, 0);
      else if (steps[b] === VOID || steps[c] === VOID) wall(a, d, 0);
    }
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
const number = (value, decimals) => value.toLocaleString('en-GB', { minimumFractionDigits: decimals, maximumFractionDigits: decimals }).replace('-', '\u2212');
function metres(value) {
  const decimals = highest - lowest >= 20 ? 0 : highest - lowest >= 2 ? 1 : 2;
  return number(+value.toFixed(decimals) + 0, decimals) + ' m';  // + 0: no minus before 0
}
const distance = value => value >= 1000 ? number(value / 1000, 0) + ' km' : String(+value.toPrecision(3)) + ' m';

async function start() {
  const canvas = element('view');
  const context = canvas.getContext('webgl2', { alpha: true, antialias: true });
  if (!context) return fail('This page needs WebGL 2, which this browser does not offer, or has switched off.');
  if (!window.DecompressionStream) return fail('This browser is too old for this page: it needs Chromium 80, Firefox 113, Safari 16.4 or later.');
  const packed = await Promise.all(['three', ...terrains.map((t, i) => 'heights-' + i)].map(inflate));
  const library = document.createElement('script');
  library.textContent = new TextDecoder().decode(packed[0]);
  document.head.append(library);
  await Promise.all(terrains.map((t, i) => element('picture-' + i).decode()));
  terrains.forEach((t, i) => {
    t.steps = readSteps(packed[i + 1], t.width, t.height);
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
  common.interval.value = page.interval;

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
  const halfView = Math.tan(camera.fov * Math.PI / 360);

  // The camera looks at `target` from `away`; azimuth 0 is south of it, tilt 0 above it.
  const target = new THREE.Vector3();
  let azimuth = 0, tilt = 0, away = 1;
  const steepest = 1e-3, flattest = 0.495 * Math.PI;
  const within = (value, low, high) => Math.min(high, Math.max(low, value));

  let split = 0.5, wanted = false;
  const size = () => [canvas.clientWidth || 1, canvas.clientHeight || 1];

  function render() {
    wanted = false;
    const [width, height] = size();
    aim();
    camera.near = Math.max(away / 400, (away - 4 * reach) / 2);
    camera.far = away + 5 * reach + (highest - lowest) * common.lift.value;
    camera.updateProjectionMatrix();
    renderer.setScissorTest(two);
    const at = Math.round(width * split);
    if (two) renderer.setScissor(0, 0, at, height);
    renderer.render(scenes[0], camera);
    if (two) {
      renderer.setScissor(at, 0, width - at, height);
      renderer.render(scenes[1], camera);
    }
    showScale(height);
    element('needle').setAttribute('transform', `rotate(${azimuth * 180 / Math.PI})`);
    root.dataset.azimuth = azimuth.toFixed(4);
    root.dataset.tilt = tilt.toFixed(4);
    root.dataset.target = target.x.toFixed(2) + ' ' + target.z.toFixed(2);
    root.dataset.distance = away.toFixed(3);
    if (root.dataset.state === 'loading') root.dataset.state = 'ready';
  }
  function draw() {
    if (wanted) return;
    wanted = true;
    requestAnimationFrame(render);
  }

  const metresPerPixel = height => 2 * away * halfView / height;
  function showScale(height) {
    if (!page.metric) return;
    const perPixel = metresPerPixel(height);
    const length = round125((size()[0] > 760 ? 100 : 54) * perPixel);
    element('bar').style.width = length / perPixel + 'px';
    element('bar-text').textContent = distance(length) + ' at the centre';
  }

  // How high the ground is drawn there; 0 beside it and in voids.
  function ground(east, south) {
    for (const t of terrains) {
      const z = heightAt(t, east, south);
      if (!Number.isNaN(z)) return (z - lowest) * common.lift.value;
    }
    return 0;
  }
  const arm = (angle, length) => new THREE.Vector3().setFromSphericalCoords(length, angle, azimuth);
  // From near by, what is looked at is the ground; the camera stays above it.
  function aim() {
    target.x = within(target.x, -1.2 * reach, 1.2 * reach);
    target.z = within(target.z, -1.2 * reach, 1.2 * reach);
    const near = within(1.6 - away / reach, 0, 1), middle = restingHeight * (1 - near) + ground(target.x, target.z) * near;
    target.y = middle;
    let angle = tilt;
    do {
      camera.position.copy(arm(angle, away)).add(target);
      angle -= 0.02;
    } while (angle > steepest && camera.position.y < ground(camera.position.x, camera.position.z) + 0.03 * away);
    camera.lookAt(target);
    camera.updateMatrixWorld();
  }

  // From the south, so that the whole block fills the window but for its rim.
  let restingHeight = 0;
  function showAll() {
    const [width, height] = size(), top = (highest - lowest) * common.lift.value;
    azimuth = 0;
    tilt = 48 * Math.PI / 180;
    const up = [Math.sin(tilt), Math.cos(tilt)];  // of a step up, over the window, and towards the camera
    const box = corners.flatMap(([x, y]) => [common.base.value, top].map(z => [x, z, y]));
    // The room that the cards leave: above the controls, on a phone below the names and above the legend too.
    const phone = width <= 760, edge = (id, side) => element(id).getBoundingClientRect()[side];
    const roof = 1 - 2 * Math.min(0.35, (phone ? Math.max(edge('label-0', 'bottom'), edge('label-1', 'bottom')) + 12 : 24) / height);
    const floor = 1 - 2 * Math.max(0.65, (edge(phone ? 'foot' : 'controls', 'top') - 12) / height);
    const share = (roof - floor) / 2, centre = (roof + floor) / 2, shareX = halfView * width / height * (phone ? 0.96 : 0.9);
    restingHeight = top / 2;
    for (let round = 0; round < 12; ++round) {
      const seen = box.map(([x, z, y]) => [x, (z - restingHeight) * up[0] - y * up[1], (z - restingHeight) * up[1] + y * up[0]]);
      away = Math.max(...seen.map(([x, y, near]) => near + Math.max(Math.abs(x) / shareX, y / (halfView * (share + centre)), -y / (halfView * (share - centre)))));
      const heights = seen.map(([x, y, near]) => y / (away - near));
      restingHeight += ((Math.max(...heights) + Math.min(...heights)) / 2 - halfView * centre) * away / up[0];
    }
    target.set(0, restingHeight, 0);
    draw();
  }

  function turn(by, tiltBy) {
    azimuth = Math.atan2(Math.sin(azimuth + by), Math.cos(azimuth + by));
    tilt = within(tilt + tiltBy, steepest, flattest);
    draw();
  }
  // To the right and away from the camera, in metres.
  function move(right, forward) {
    target.x += right * Math.cos(azimuth) - forward * Math.sin(azimuth);
    target.z += -right * Math.sin(azimuth) - forward * Math.cos(azimuth);
    draw();
  }
  // Pixels of the window, down its y, on the ground.
  function slide(x, y) {
    const perPixel = metresPerPixel(size()[1]);
    move(x * perPixel, -y * perPixel / Math.max(0.3, Math.cos(tilt)));
  }
  // What is at that pixel stays there.
  function zoom(factor, x, y) {
    const [width, height] = size(), before = away;
    away = within(away * factor, reach / 200, 8 * reach);
    if (x !== undefined) slide((x - width / 2) * (before / away - 1), (y - height / 2) * (before / away - 1));
    draw();
  }
  const northUp = () => turn(-azimuth, 0);

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
    if (root.dataset.state === 'loading') return;
    const [width, height] = size(), t = terrains[two && event.clientX > width * split ? 1 : 0];
    const ray = new THREE.Raycaster();
    aim();
    ray.setFromCamera({ x: 2 * event.clientX / width - 1, y: 1 - 2 * event.clientY / height }, camera);
    const { origin, direction } = ray.ray, top = (highest - lowest) * common.lift.value;
    let text = '';
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
    element('ramp').style.backgroundImage = `linear-gradient(90deg, ${page.ramp.join(',')})`;
    // The ramp ends where few cells are beyond.
    element('ramp-low').textContent = (page.low > lowest + 0.5 ? '\u2264 ' : '') + metres(page.low);
    element('ramp-middle').textContent = metres((page.low + page.high) / 2);
    element('ramp-high').textContent = (page.high < highest - 0.5 ? '\u2265 ' : '') + metres(page.high);
    element('legend').hidden = false;
  }
  element('scale').hidden = !page.metric;
  element('interval').textContent = highest > lowest ? `every ${+common.interval.value.toPrecision(3)} m` : '';
  element('divider').hidden = !two;

  // One pointer turns, or moves with another button or shift; two move, zoom and twist. Two short taps, or clicks, show all.
  const pointers = new Map();
  let tap = null, lastTap = null;
  const framed = window.parent !== window, whole = () => !framed || document.fullscreenElement;
  root.classList.toggle('framed', framed);
  function gesture() {
    const [a, b] = pointers.values();
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, spread: Math.max(10, Math.hypot(b.x - a.x, b.y - a.y)), angle: Math.atan2(b.y - a.y, b.x - a.x) };
  }
  canvas.addEventListener('pointerdown', event => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, moves: event.button > 0 || event.shiftKey || event.ctrlKey || event.metaKey });
    tap = pointers.size === 1 && event.button === 0 ? { x: event.clientX, y: event.clientY, time: event.timeStamp } : null;
    canvas.focus({ preventScroll: true });
  });
  canvas.addEventListener('pointermove', event => {
    const pointer = pointers.get(event.pointerId);
    if (!pointer) return readOut(event);
    if (tap && Math.hypot(event.clientX - tap.x, event.clientY - tap.y) > 8) tap = null;
    const before = pointers.size === 2 ? gesture() : null, x = event.clientX - pointer.x, y = event.clientY - pointer.y;
    pointer.x = event.clientX;
    pointer.y = event.clientY;
    if (before) {
      const after = gesture();
      slide(before.x - after.x, before.y - after.y);
      zoom(before.spread / after.spread, after.x, after.y);
      const twist = after.angle - before.angle;
      turn(Math.atan2(Math.sin(twist), Math.cos(twist)), 0);
    } else if (pointers.size === 1) {
      const perPixel = 1.4 * Math.PI / size()[1];
      if (pointer.moves) slide(-x, -y);
      else turn(-x * perPixel, -y * perPixel);
    }
  });
  canvas.addEventListener('pointerup', event => {
    pointers.delete(event.pointerId);
    const short = tap && event.timeStamp - tap.time < 400;
    if (!short) return;
    readOut(event);
    if (lastTap && event.timeStamp - lastTap.time < 450 && Math.hypot(event.clientX - lastTap.x, event.clientY - lastTap.y) < 30) {
      showAll();
      lastTap = null;
    } else lastTap = { x: event.clientX, y: event.clientY, time: event.timeStamp };
  });
  for (const name of ['pointercancel', 'lostpointercapture']) canvas.addEventListener(name, event => pointers.delete(event.pointerId));
  canvas.addEventListener('pointerleave', event => { if (event.pointerType === 'mouse') element('readout').textContent = ''; });
  // Within another page the wheel scrolls that page, until the terrain has been clicked.
  canvas.addEventListener('wheel', event => {
    if (!whole() && document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    const lines = event.deltaY * (event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1);
    zoom(Math.pow(1.0016, within(lines, -400, 400)), event.clientX, event.clientY);
  }, { passive: false });
  document.addEventListener('mouseleave', () => { if (!whole()) canvas.blur(); });

  window.addEventListener('resize', resize);
  canvas.addEventListener('contextmenu', event => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', draw);
  canvas.addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (step && event.shiftKey) move(step[0] * 0.06 * away, step[1] * 0.06 * away);
    else if (step) turn(step[0] * 0.08, -step[1] * 0.06);
    else if (event.key === '+' || event.key === '=') zoom(0.85);
    else if (event.key === '-') zoom(1 / 0.85);
    else if (event.key === 'n' || event.key === 'N') northUp();
    else if (event.key === '0' || event.key === 'Home') showAll();
    else return;
    event.preventDefault();
  });
  for (const name of ['contours', 'grid'])
    element(name).addEventListener('change', event => { common[name].value = event.target.checked; draw(); });
  element('reset').addEventListener('click', showAll);
  element('compass').addEventListener('click', northUp);
  element('fill').hidden = !framed || !document.fullscreenEnabled;
  element('fill').addEventListener('click', () => document.fullscreenElement ? document.exitFullscreen() : root.requestFullscreen().catch(() => {}));
  document.addEventListener('fullscreenchange', () => { element('fill').textContent = document.fullscreenElement ? 'Leave full screen' : 'Fill screen'; });
  element('ask').addEventListener('click', () => element('about').showModal());
  element('help').textContent = matchMedia('(pointer: coarse)').matches ? 'One finger turns, two move and zoom, two taps show all'
    : framed ? 'Drag turns, right button or shift moves; after a click the wheel zooms' : 'Drag turns, right button or shift moves, wheel zooms';
  element('maker').textContent = 'Arete ' + page.version;
  const digits = value => String(+value.toPrecision(3));
  element('accuracy').textContent = terrains.filter(t => t.step > 0).map(t =>
    `Heights of ${t.name} are kept in steps of ${digits(t.step)} m: none is off by more than ${digits(t.step / 2)} m.`).join(' ');
  element('credit').textContent = page.credit;
  element('credit').hidden = !page.credit;
  element('key').classList.toggle('credited', Boolean(page.credit));
  element('controls').addEventListener('submit', event => event.preventDefault());
  const divider = element('divider');
  divider.addEventListener('pointerdown', event => { divider.setPointerCapture(event.pointerId); event.preventDefault(); divider.focus(); });
  divider.addEventListener('pointermove', event => { if (divider.hasPointerCapture(event.pointerId)) setSplit(event.clientX / size()[0]); });
  divider.addEventListener('wheel', event => { if (!canvas.dispatchEvent(new WheelEvent('wheel', event))) event.preventDefault(); }, { passive: false });
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

start().catch(error => fail('The terrain could not be drawn: ' + error.message));
})();
