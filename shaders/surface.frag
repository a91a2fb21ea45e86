#version 450 core
// Colours of what is seen of a terrain. The number of a surface: 1 + 8 layer of the tile + side.
#include "light.glsl"
#include "samples.glsl"
#include "ground.glsl"

layout(std430, binding = 0) readonly buffer Tiles { ivec4 tiles[]; };  // by layer: column and row of the first sample, level

uniform sampler2DArray shapes;   // height, its change per column and per row, water: smoothed
uniform vec2 light_scale;        // texture coordinate = (sample + 0.5) * light_scale
uniform ivec2 eye_sample;
uniform vec2 eye_part;
uniform float eye_height;
uniform vec2 cell;
uniform float exaggeration;
uniform float base;

bool is_floor(uint number) { return (number - 1u & 7u) == 5u; }

vec3 surface_colour(uint number, vec3 from_eye, float ahead) {
  int surface = int(number - 1u), side = surface & 7, layer = surface >> 3;
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
    shade = lit_wall(face, depth_below);
  } else {
    vec2 slope = vec2(shape.g, -shape.b) / cell;  // rise per metre to the east and to the north
    vec3 normal = normalize(vec3(-slope * exaggeration, 1.0));
    vec2 open = textureLod(light, (vec2(eye_sample) + away + 0.5) * light_scale, 0.0).rg;
    if (mode == 1) {
      vec3 hue = 0.5 + 0.5 * cos(6.2832 * (float(tile.z) * 0.381966 + vec3(0.0, 0.33, 0.67)));
      shade = lit(mix(vec3(0.75), hue, 0.6), normal, open);
    } else {
      float wet = smoothstep(0.35, 0.65, shape.a);
      shade = mix(land_shade(shape.r, slope, normal, open), water_shade(from_eye), wet);
      shade = add_marks(shade, shape.r, slope, normal, open, vec2(eye_sample) + away, wet, from_eye, ahead);
    }
  }
  return roll_off(shade);
}
