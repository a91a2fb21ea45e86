#version 450 core
// Colours of what is seen of a mesh. The number of a surface: 1 + triangle.
#include "light.glsl"
#include "samples.glsl"
#include "ground.glsl"
#include "mesh_place.glsl"

layout(std430, binding = 0) readonly buffer Places { ivec4 places[]; };    // x, y, z, normal
layout(std430, binding = 1) readonly buffer Triangles { uint corners[]; };
uniform ivec3 first_of;       // wall, side of a hole, floor
uniform int sea_place;        // z of 0 m
uniform float eye_height;     // exaggerated metres
uniform float exaggeration;
uniform vec2 eye_cells;       // column and row below the eye, of the picture that lies over the ground
uniform vec2 eye_in_light;    // texture coordinates below the eye
uniform vec2 light_scale;     // and per metre
uniform mat4 projection;
uniform float line_width;     // pixels; 0: no lines

// What of a facet is always seen as such, and the angles to the mean of its neighbours (cosines) from which on it begins to be, and wholly is.
const float facet = 0.25, smooth_until = 0.82, edge_from = 0.5;

bool is_floor(uint number) { return number > uint(first_of.y); }

vec3 normal_of(int bits) {
  vec2 folded = unpackSnorm2x16(uint(bits));
  vec3 n = vec3(folded, 1.0 - abs(folded.x) - abs(folded.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  return normalize(n);
}

// How much of a pixel the line along the side from a to b covers; fainter where the triangle is so small that lines would hide it. In pixels from the middle
// of the picture, times w.
float line_cover(vec3 a, vec3 b, vec3 opposite, vec2 at) {
  vec3 side = cross(a, b);
  side /= max(length(side.xy), 1e-30);
  float height = opposite.z > 0.0 ? abs(dot(side, opposite)) / opposite.z : 1e6;
  float cover = clamp(0.5 * line_width + 0.5 - abs(dot(side, vec3(at, 1.0))), 0.0, 1.0);
  return cover * mix(0.12, 0.9, smoothstep(1.5, 6.0, height / line_width));
}

vec3 on_picture(vec3 from_eye) {
  vec4 clip = projection * vec4(from_eye, 1.0);
  return vec3(clip.xy / pixel, clip.w);
}

vec3 ground_colour(ivec4 a, ivec4 b, ivec4 c, vec3 share, vec3 face, vec3 from_eye, float ahead) {
  float height = (from_eye.z + eye_height) / exaggeration;
  vec2 open = textureLod(light, eye_in_light + from_eye.xy * light_scale, 0.0).rg;
  if (a.z == b.z && b.z == c.z && a.z <= sea_place) return water_shade(from_eye);
  vec3 mean = share.x * normal_of(a.w) + share.y * normal_of(b.w) + share.z * normal_of(c.w);
  mean = normalize(vec3(mean.xy * exaggeration, mean.z));
  float edge = 1.0 - smoothstep(edge_from, smooth_until, dot(mean, face));
  vec3 normal = normalize(mix(mean, face, max(edge, facet)));
  vec2 slope = -normal.xy / (max(normal.z, 1e-3) * exaggeration), own = -face.xy / (max(face.z, 1e-3) * exaggeration);
  vec3 shade = land_shade(height, slope, normal, open);
  // Lines are as wide as the facet that they lie on tells.
  return add_marks(shade, height, own, face, open, eye_cells + vec2(from_eye.x, -from_eye.y) / drape_cell, 0.0, from_eye, ahead);
}

vec3 surface_colour(uint number, vec3 from_eye, float ahead) {
  int triangle = int(number - 1u);
  if (triangle >= first_of.z) return floor_colour;
  ivec4 a = places[corners[3 * triangle]], b = places[corners[3 * triangle + 1]], c = places[corners[3 * triangle + 2]];
  vec3 at_a = from_eye_of(a.xyz), at_b = from_eye_of(b.xyz), at_c = from_eye_of(c.xyz);
  vec3 across = cross(at_b - at_a, at_c - at_a), face = normalize(across);
  vec3 share = max(vec3(dot(cross(at_b - from_eye, at_c - from_eye), across), dot(cross(at_c - from_eye, at_a - from_eye), across),
                        dot(cross(at_a - from_eye, at_b - from_eye), across)), 0.0);
  share /= max(share.x + share.y + share.z, 1e-30);
  if (triangle >= first_of.x) {
    float depth_below = dot(share, vec3(lessThan(ivec3(a.z, b.z, c.z), ivec3(0))));
    vec3 wall = lit_wall(normalize(share.x * normal_of(a.w) + share.y * normal_of(b.w) + share.z * normal_of(c.w)), depth_below);
    if (triangle < first_of.y) return roll_off(wall);
    float open = 1.0 - depth_below;
    return mix(floor_colour, 0.45 * mix(wall, wall_colour * 0.7, 0.6), open * open * open);
  }
  vec3 shade = roll_off(ground_colour(a, b, c, share, face, from_eye, ahead));
  if (line_width > 0.0) {
    vec3 p = on_picture(at_a), q = on_picture(at_b), r = on_picture(at_c), here = on_picture(from_eye);
    vec2 at = here.xy / here.z;
    shade = mix(shade, line_colour, max(line_cover(p, q, r, at), max(line_cover(q, r, p, at), line_cover(r, p, q, at))));
  }
  return shade;
}
