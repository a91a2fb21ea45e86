#version 450 core
layout(vertices = 4) out;

in ivec4 patch_node[];
in ivec4 patch_outer[];
in ivec4 patch_inside[];
patch out ivec4 node;
patch out ivec3 side_number_above;

void main() {
  if (gl_InvocationID != 0) return;
  node = patch_node[0];
  side_number_above = patch_inside[0].yzw;
  for (int i = 0; i < 4; ++i) gl_TessLevelOuter[i] = float(patch_outer[0][i]);
  gl_TessLevelInner[0] = float(patch_inside[0].x & 255);
  gl_TessLevelInner[1] = float(patch_inside[0].x >> 8);
}
