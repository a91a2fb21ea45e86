#version 450 core
uniform vec3 haze_colour;
uniform vec3 zenith_colour;
uniform vec3 below_colour;
uniform int mode;

in vec3 ray;
layout(location = 0) out vec4 colour;

void main() {
  if (mode == 2) {
    colour = vec4(0.0);
    return;
  }
  float up = normalize(ray).z;
  vec3 above = mix(haze_colour, zenith_colour, 1.0 - exp(-3.0 * max(up, 0.0)));
  colour = vec4(mix(above, below_colour, smoothstep(0.0, 1.0, -up * 1.2)), 1.0);
}
