#version 450 core
layout(vertices = 4) out;

in ivec4 patch_node[];
in ivec4 patch_outer[];
in ivec4 patch_inside[];
patch out ivec4 node;
patch out ivec2 side_and_number;

void main() {
  if (gl_InvocationID != 0) return;
  node = patch_node[0];
  side_and_number = patch_inside[0].zw;
  for (int i = 0; i < 4; ++i) gl_TessLevelOuter[i] = float(patch_outer[0][i]);
  gl_TessLevelInner[0] = float(patch_inside[0].x);
  gl_TessLevelInner[1] = float(patch_inside[0].y);
}
