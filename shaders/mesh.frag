#version 450 core
// What is seen (mesh_surface.frag): 1 + triangle.
uniform uint first;  // of the triangles that are drawn
layout(location = 0) out uint seen;

void main() { seen = first + uint(gl_PrimitiveID) + 1u; }
