#version 460
// The first Chebyshev step from zero: y = d = c0 D^-1 b.
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Field d = scaled(vec3(push.c0), solved(Entries(push.diagonal).at[i], Fields(push.b).at[i]));
  Fields(push.d).at[i] = d;
  Fields(push.y).at[i] = d;
}
