#version 450 core
// Every vertex lies on a sample of the tile: levels are powers of two up to 64, the tile has 65 samples aside and a border of one.
layout(quads, equal_spacing, ccw) in;

uniform sampler2DArray tiles;  // height, smoothed height, validity, water
uniform ivec2 last;            // column and row of the last sample of the terrain
uniform ivec2 eye_sample;      // the eye is at sample eye_sample + eye_part, at the height eye_height
uniform vec2 eye_part;
uniform float eye_height;
uniform vec2 cell;             // metres
uniform float exaggeration;
uniform float base;            // height of the foot of the walls, in exaggerated metres
uniform mat4 projection;       // of positions from the eye

patch in ivec4 node;
patch in int side;

out vec3 from_eye;       // metres: east, north, up
out vec2 texel;          // 0..64 in the tile
out float depth_below;   // 0 at the ground, 1 at the foot of a wall
flat out ivec4 tile;     // node and side
out vec3 sample_height;  // column, row, height, for transform feedback

void main() {
  ivec2 at = ivec2(round(gl_TessCoord.xy * 64.0));
  depth_below = 0.0;
  if (side == 5) {
    depth_below = 1.0;
  } else if (side > 0) {
    int along = at.x;
    depth_below = 1.0 - gl_TessCoord.y;
    at = side == 1 ? ivec2(0, along) : side == 2 ? ivec2(along, 0) : side == 3 ? ivec2(64, along) : ivec2(along, 64);
  }
  // Both sides of an edge reach the same sample and the same sums, so that their vertices are the same to the last bit.
  ivec2 at_sample = min(node.xy + (at << node.z), last);
  float height = texelFetch(tiles, ivec3(at + 1, node.w), 0).r;
  precise vec2 ground = (vec2(at_sample - eye_sample) - eye_part) * cell;
  precise float up = (depth_below > 0.0 ? mix(height * exaggeration, base, depth_below) : height * exaggeration) - eye_height;
  from_eye = vec3(ground.x, -ground.y, up);
  precise vec4 clip = projection * vec4(from_eye, 1.0);
  gl_Position = clip;
  texel = vec2(at);
  tile = ivec4(node.z, node.w, side, 0);
  sample_height = vec3(vec2(at_sample), height);
}
