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
uniform sampler1D ramp;          // colours of heights, linear
uniform vec2 ramp_range;         // lowest height and 1 / span
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
uniform bool rolls_off;          // highlights do
uniform int mode;                // 0: lit, 1: colours of levels, 2: covered

layout(location = 0) out vec4 colour;

const uint line_mark = 0x80000000u;
const vec3 wall_colour = vec3(0.60, 0.56, 0.515), floor_colour = vec3(0.115, 0.112, 0.118), line_colour = vec3(0.02, 0.03, 0.05);
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

vec3 land_colour(float height) { return textureLod(ramp, (height - ramp_range.x) * ramp_range.y, 0.0).rgb; }

vec3 surface_colour(int layer, int side, vec3 from_eye) {
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
      shade = lit(land_colour(shape.r), normal, open);
      float wet = smoothstep(0.35, 0.65, shape.a);
      float grazing = 1.0 + clamp(from_eye.z * inversesqrt(dot(from_eye, from_eye)), -1.0, 0.0);
      grazing *= grazing;
      grazing *= grazing;
      vec3 water = mix(lit(water_colour, vec3(0, 0, 1), vec2(1.0)), haze_colour, 0.5 * grazing);
      shade = mix(shade, water, wet);
    }
  }
  return rolls_off ? roll_off(shade) : shade;
}

vec3 seen_colour(uint number, vec3 ray, float depth) {
  if (number == 0u) return sky_colour(ray);
  vec3 from_eye = ray * (near / depth);
  int surface = int((number & ~line_mark) - 1u), side = surface & 7;
  bool line = (number & line_mark) != 0u && side != 5;
  if (line) return line_colour;
  vec3 shade = surface_colour(surface >> 3, side, from_eye);
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
