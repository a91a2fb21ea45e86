#version 450 core
// What is seen (surface.frag): of patches with voids, which are holes.
uniform sampler2DArray heights;
uniform uint marks;

flat in uint number;
flat in int layer;
in vec2 texel;
layout(location = 0) out uint seen;

void main() {
  if (textureLod(heights, vec3((texel + 0.5) / 65.0, float(layer)), 0.0).g < 0.5) discard;
  seen = number | marks;
}
