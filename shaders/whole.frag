#version 450 core
// What is seen (surface.frag): of patches without voids.
uniform uint marks;  // bits set besides

flat in uint number;
layout(location = 0) out uint seen;

void main() { seen = number | marks; }
