#version 460
// y = b - A x.
#extension GL_GOOGLE_include_directive : require
#include "rows.glsl"

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= push.count) return;
  uint i = row_of(slot);
  Row row = row_at(i, load(push.x, i));
  store(push.y, i, difference(Fields(push.b).at[i], row_times(slot, row)));
}
