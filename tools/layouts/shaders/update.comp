#version 460
// d = c1 d + c2 D^-1 b, y = x + d.
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Field z = solved(Entries(push.diagonal).at[i], Fields(push.b).at[i]);
  Field d = add_scaled(scaled(vec3(push.c1), Fields(push.d).at[i]), vec3(push.c2), z);
  Fields(push.d).at[i] = d;
  Fields(push.y).at[i] = add(Fields(push.x).at[i], d);
}
