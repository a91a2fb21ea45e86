#version 450 core
// Places are whole numbers, the difference to the eye is exact: triangles that share a vertex have the same to the last bit.
#include "mesh_place.glsl"

layout(location = 0) in ivec3 place;
uniform mat4 projection;  // of positions from the eye

void main() {
  precise vec4 clip = projection * vec4(from_eye_of(place), 1.0);
  gl_Position = clip;
}
