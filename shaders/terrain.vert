#version 450 core
// Each of its vertices is the whole patch; the tessellator makes those that are drawn.
layout(location = 0) in ivec4 node;    // column and row of the first sample, level, layer of its tile
layout(location = 1) in ivec4 outer;   // segments of the sides: west, north, east, south
layout(location = 2) in ivec4 inside;  // segments inside: along columns, along rows; side (0: ground, 1..4: wall); what is seen of it (surface.frag)

out ivec4 patch_node;
out ivec4 patch_outer;
out ivec4 patch_inside;

void main() {
  patch_node = node;
  patch_outer = outer;
  patch_inside = inside;
}
