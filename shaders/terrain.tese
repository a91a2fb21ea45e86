#version 450 core
// Every vertex lies on a sample of the tile: levels are powers of two up to 16, a patch has 17 samples aside, a tile those of 4 x 4 patches.
layout(quads, equal_spacing, ccw) in;

uniform sampler2DArray heights;  // height, validity
uniform ivec2 last;              // column and row of the last sample of the terrain
uniform ivec2 eye_sample;        // the eye is at sample eye_sample + eye_part, at the height eye_height
uniform vec2 eye_part;
uniform float eye_height;
uniform vec2 cell;               // metres
uniform float exaggeration;
uniform float base;              // height of the foot of the walls, in exaggerated metres
uniform mat4 projection;         // of positions from the eye

patch in ivec4 node;
patch in ivec2 side_and_number;

flat out uint number;
flat out int layer;
out vec2 texel;          // 0..64 in the tile
out vec3 sample_height;  // column, row, height, for transform feedback

void main() {
  ivec2 at = ivec2(round(gl_TessCoord.xy * 16.0));
  int side = side_and_number.x;
  float depth_below = 0.0;  // 0 at the ground, 1 at the foot of a wall
  if (side == 5) {
    depth_below = 1.0;
  } else if (side > 0) {
    int along = at.x;
    depth_below = 1.0 - gl_TessCoord.y;
    at = side == 1 ? ivec2(0, along) : side == 2 ? ivec2(along, 0) : side == 3 ? ivec2(16, along) : ivec2(along, 16);
  }
  // Both sides of an edge reach the same sample and the same sums, so that their vertices are the same to the last bit.
  ivec2 at_sample = min(node.xy + (at << node.z), last);
  ivec2 in_tile = ((node.xy >> node.z) & 63) + at;
  float height = texelFetch(heights, ivec3(in_tile, node.w), 0).r;
  precise vec2 ground = (vec2(at_sample - eye_sample) - eye_part) * cell;
  precise float up = (depth_below > 0.0 ? mix(height * exaggeration, base, depth_below) : height * exaggeration) - eye_height;
  precise vec4 clip = projection * vec4(ground.x, -ground.y, up, 1.0);
  gl_Position = clip;
  texel = vec2(in_tile);
  layer = node.w;
  number = uint(side_and_number.y);
  sample_height = vec3(vec2(at_sample), height);
}
