#version 450 core
// A triangle over the whole picture, as far as can be.
uniform mat4 to_ray;  // from clip coordinates to a direction

out vec3 ray;

void main() {
  vec2 at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  ray = (to_ray * vec4(at, 0.0, 1.0)).xyz;
  gl_Position = vec4(at, 0.0, 1.0);
}
