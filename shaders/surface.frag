#version 450 core
// Colours of what is seen, once per pixel and surface: samples of a pixel that show the same tile at about the same depth share one.
uniform usampler2DMS seen;       // 1 + 8 layer of the tile + side, 0 for the sky; the highest bit for lines
uniform sampler2DMS depths;      // near / distance ahead
uniform vec4 offsets_x;          // of the samples from the middle of a pixel
uniform vec4 offsets_y;
uniform vec2 pixel;              // in clip coordinates
uniform mat4 to_ray;             // from clip coordinates to a direction, 1 long ahead
uniform float near;
layout(std430, binding = 0) readonly buffer Tiles { ivec4 tiles[]; };  // by layer: column and row of the first sample, level

uniform sampler2DArray shapes;   // height, its change per column and per row, water: smoothed
uniform sampler2D light;         // sky, sun, over the whole terrain
uniform vec2 light_scale;        // texture coordinate = (sample + 0.5) * light_scale
uniform sampler1DArray ramps;     // colours of heights, slopes and aspects, linear
uniform vec2 ramp_range;         // lowest height and 1 / span
uniform int coloured;            // 0: heights, 1: slopes, 2: aspects
uniform float slope_scale;       // 1 / degrees of the end of the colours of slopes
uniform vec2 facing;             // shares of that end: grey below, all of the colour of aspects above
uniform vec3 flat_colour;
uniform float contours;          // 1 / interval in metres; 0: none
uniform float line_px;           // pixels aside that make one of the picture
uniform bool draped;             // a picture lies over the ground
uniform sampler2D drape;         // colours times opacity, opacity; an atlas of levels (picture_atlas.h)
uniform float drape_rows[15];    // where they begin
uniform int drape_last;          // level
uniform vec2 drape_size;         // of level 0
uniform vec2 drape_corner;       // column and row of the DEM where it begins
uniform vec2 drape_scale;        // pixels per column and row
uniform ivec2 eye_sample;
uniform vec2 eye_part;
uniform float eye_height;
uniform vec2 cell;
uniform float exaggeration;
uniform float base;
uniform vec3 to_sun;             // east, north, up
uniform vec3 water_colour;       // linear
uniform vec3 haze_colour;
uniform vec3 zenith_colour;
uniform vec3 below_colour;
uniform float haze;              // per metre
uniform float haze_from;         // metres from the eye
uniform int mode;                // 0: lit, 1: colours of levels, 2: covered

layout(location = 0) out vec4 colour;

const uint line_mark = 0x80000000u;
const vec3 wall_colour = vec3(0.60, 0.56, 0.515), floor_colour = vec3(0.115, 0.112, 0.118), line_colour = vec3(0.02, 0.03, 0.05);
const vec3 line_ink = vec3(0.055, 0.024, 0.012);
const float line_opacity = 0.75;
const vec3 sun_light = vec3(1.12, 1.04, 0.91), sky_light = vec3(0.225, 0.265, 0.345), bounce = vec3(0.05, 0.043, 0.034);

vec3 lit(vec3 albedo, vec3 normal, vec2 open) {
  float direct = max(dot(normal, to_sun), 0.0) * open.y;
  float sky = open.x * (0.5 + 0.5 * normal.z);
  return albedo * (sun_light * direct + sky_light * sky + bounce * (1.0 - 0.5 * normal.z));
}

// Highlights roll off instead of clipping.
vec3 roll_off(vec3 c) { return mix(c, 0.7 + 0.3 * (1.0 - exp(-(c - 0.7) / 0.3)), step(0.7, c)); }

vec3 sky_colour(vec3 ray) {
  float up = normalize(ray).z;
  vec3 above = mix(haze_colour, zenith_colour, 1.0 - exp(-3.0 * max(up, 0.0)));
  return mix(above, below_colour, smoothstep(0.0, 1.0, -up * 1.2));
}

// Slope: rise per metre to the east and to the north, without exaggeration.
vec3 land_colour(float height, vec2 slope) {
  if (coloured == 0) return textureLod(ramps, vec2((height - ramp_range.x) * ramp_range.y, 0.0), 0.0).rgb;
  float steep = degrees(atan(length(slope))) * slope_scale;
  if (coloured == 1) return textureLod(ramps, vec2(steep, 1.0), 0.0).rgb;
  float turn = slope == vec2(0.0) ? 0.0 : atan(-slope.x, -slope.y) / radians(360.0);  // downhill, clockwise from north
  return mix(flat_colour, textureLod(ramps, vec2(fract(turn), 2.0), 0.0).rgb, smoothstep(facing.x, facing.y, steep));
}

// How far away on the plane through a point of the ground the pixels to the right and above see it: east, north. `ahead`: how far ahead the point is.
mat2 pixel_steps(vec3 from_eye, float ahead, vec3 normal) {
  vec3 right = (to_ray * vec4(pixel.x, 0.0, 0.0, 0.0)).xyz * ahead, above = (to_ray * vec4(0.0, pixel.y, 0.0, 0.0)).xyz * ahead;
  float facing_eye = min(dot(normal, from_eye), -0.01 * length(from_eye));
  return mat2((right - from_eye * (dot(normal, right) / facing_eye)).xy, (above - from_eye * (dot(normal, above) / facing_eye)).xy);
}

// How much of a pixel a contour covers where the level, 1 from line to line, changes so much from pixel to pixel of the picture.
float line_share(float level, float change, float width_px) {
  float apart = abs(level - round(level)) / max(change, 1e-9);
  return clamp((0.5 * width_px - apart) * line_px + 0.5, 0.0, 1.0) * (1.0 - smoothstep(0.2, 0.4, change));
}

// Dark lines at the multiples of the interval, every fifth thicker. A little aside: else ground that is level at just a multiple has a line all over it.
vec3 add_contours(vec3 shade, float height, vec2 slope, mat2 steps) {
  float level = height * contours + 1.0 / 1024.0, change = length(slope * steps) * contours * line_px;
  return mix(shade, line_ink, line_opacity * max(line_share(level, change, 1.0), line_share(0.2 * level, 0.2 * change, 1.9)));
}

vec4 drape_level(vec2 place, int level) {
  vec2 at = clamp(place * exp2(-float(level)), vec2(0.5), ceil(drape_size * exp2(-float(level))) - 0.5);
  at += vec2(level > 0 ? drape_size.x : 0.0, drape_rows[level]);
  return textureLod(drape, at / vec2(textureSize(drape, 0)), 0.0);
}

// Trilinear, several times along the longer side of what the pixel sees.
vec4 drape_colour(vec2 place, mat2 steps) {
  float a = length(steps[0]), b = length(steps[1]), longer = max(a, b), shorter = max(min(a, b), 1e-6);
  float count = clamp(ceil(longer / shorter - 0.01), 1.0, 6.0);
  float level = clamp(log2(max(longer / count, 1e-6)), 0.0, float(drape_last));
  vec2 along = (a > b ? steps[0] : steps[1]) / count;
  vec4 sum = vec4(0.0);
  for (float i = 0.5 - 0.5 * count; i < 0.5 * count; i += 1.0)
    sum += mix(drape_level(place + i * along, int(level)), drape_level(place + i * along, min(int(level) + 1, drape_last)), fract(level));
  return sum / count;
}

// The picture that lies over the ground, lightly lit: it has a light of its own.
vec3 add_drape(vec3 shade, vec2 at, vec3 normal, vec2 open, mat2 steps) {
  vec2 place = (at - drape_corner) * drape_scale;
  if (clamp(place, vec2(0.0), drape_size) != place) return shade;
  vec2 to_pixels = vec2(1.0, -1.0) / cell * drape_scale;
  vec4 picture = drape_colour(place, mat2(steps[0] * to_pixels, steps[1] * to_pixels));
  vec3 light_here = lit(vec3(1.0), normal, open) / lit(vec3(1.0), vec3(0, 0, 1), vec2(1.0));
  return picture.rgb * mix(vec3(1.0), light_here, 0.5) + shade * (1.0 - picture.a);
}

vec3 surface_colour(int layer, int side, vec3 from_eye, float ahead) {
  ivec4 tile = tiles[layer];
  vec2 away = eye_part + vec2(from_eye.x, -from_eye.y) / cell;  // samples from eye_sample
  vec2 texel = (vec2(eye_sample - tile.xy) + away) / float(1 << tile.z);
  vec4 shape = textureLod(shapes, vec3((clamp(texel, 0.0, 64.0) + 0.5) / 65.0, float(layer)), 0.0);
  vec3 shade;
  if (side == 5) {
    shade = floor_colour;
  } else if (side > 0) {
    vec3 face = side == 1 ? vec3(-1, 0, 0) : side == 2 ? vec3(0, 1, 0) : side == 3 ? vec3(1, 0, 0) : vec3(0, -1, 0);
    float ground = shape.r * exaggeration, depth_below = clamp((ground - from_eye.z - eye_height) / max(ground - base, 1e-6), 0.0, 1.0);
    shade = wall_colour * (0.52 + 0.3 * max(dot(face, to_sun), 0.0) + 0.06 * face.y) * mix(1.0, 0.85, depth_below);
  } else {
    vec2 slope = vec2(shape.g, -shape.b) / cell;  // rise per metre to the east and to the north
    vec3 normal = normalize(vec3(-slope * exaggeration, 1.0));
    vec2 open = textureLod(light, (vec2(eye_sample) + away + 0.5) * light_scale, 0.0).rg;
    if (mode == 1) {
      vec3 hue = 0.5 + 0.5 * cos(6.2832 * (float(tile.z) * 0.381966 + vec3(0.0, 0.33, 0.67)));
      shade = lit(mix(vec3(0.75), hue, 0.6), normal, open);
    } else {
      vec3 land = land_colour(shape.r, slope);
      shade = lit(land, normal, open);
      // Slopes and aspects are told by the colours: the light tells less.
      if (coloured != 0) shade = mix(shade, lit(land, vec3(0, 0, 1), vec2(1.0)), 0.4);
      float wet = smoothstep(0.35, 0.65, shape.a);
      float grazing = 1.0 + clamp(from_eye.z * inversesqrt(dot(from_eye, from_eye)), -1.0, 0.0);
      grazing *= grazing;
      grazing *= grazing;
      vec3 water = mix(lit(water_colour, vec3(0, 0, 1), vec2(1.0)), haze_colour, 0.5 * grazing);
      mat2 steps = draped || contours > 0.0 ? pixel_steps(from_eye, ahead, normal) : mat2(0.0);
      shade = mix(shade, water, wet);
      if (draped) shade = add_drape(shade, vec2(eye_sample) + away, normal, open, steps);
      if (contours > 0.0 && wet < 1.0) shade = mix(add_contours(shade, shape.r, slope, steps), shade, wet);
    }
  }
  return roll_off(shade);
}

vec3 seen_colour(uint number, vec3 ray, float depth) {
  if (number == 0u) return sky_colour(ray);
  vec3 from_eye = ray * (near / depth);
  int surface = int((number & ~line_mark) - 1u), side = surface & 7;
  bool line = (number & line_mark) != 0u && side != 5;
  if (line) return line_colour;
  vec3 shade = surface_colour(surface >> 3, side, from_eye, near / depth);
  // Blue is scattered more than red.
  vec3 clear = exp(-max(length(from_eye) - haze_from, 0.0) * haze * vec3(0.85, 1.0, 1.2));
  return mix(haze_colour, shade, clear);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  uvec4 numbers = uvec4(texelFetch(seen, at, 0).r, texelFetch(seen, at, 1).r, texelFetch(seen, at, 2).r, texelFetch(seen, at, 3).r);
  if (mode == 2) {
    colour = vec4(numbers.x != 0u && (numbers.x - 1u & 7u) != 5u ? 1.0 : 0.0);
    return;
  }
  vec4 depth = vec4(texelFetch(depths, at, 0).r, texelFetch(depths, at, 1).r, texelFetch(depths, at, 2).r, texelFetch(depths, at, 3).r);
  vec3 sum = vec3(0.0);
  vec4 left = vec4(1.0);  // samples that have no colour yet
  do {
    uint number = left.x > 0.0 ? numbers.x : left.y > 0.0 ? numbers.y : left.z > 0.0 ? numbers.z : numbers.w;
    float first = left.x > 0.0 ? depth.x : left.y > 0.0 ? depth.y : left.z > 0.0 ? depth.z : depth.w;
    vec4 alike = left * vec4(equal(numbers, uvec4(number))) * vec4(lessThanEqual(abs(depth - first), vec4(0.02 * first)));
    left -= alike;
    float count = dot(alike, vec4(1.0));
    vec2 clip = (gl_FragCoord.xy + vec2(dot(alike, offsets_x), dot(alike, offsets_y)) / count) * pixel - 1.0;
    sum += count * seen_colour(number, (to_ray * vec4(clip, 0.0, 1.0)).xyz, dot(alike, depth) / count);
  } while (dot(left, vec4(1.0)) > 0.0);
  colour = vec4(0.25 * sum, 1.0);
}
