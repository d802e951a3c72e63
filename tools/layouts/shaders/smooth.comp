#version 460
// One Chebyshev step: d = c1 d + c2 D^-1 (b - A x), y = x + d. With FROM_ZERO two of them: x = d = c0 D^-1 b before.
#extension GL_GOOGLE_include_directive : require
#include "rows.glsl"

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= push.count) return;
  uint i = row_of(slot);
  Field own = neighbour(i);
#ifdef FROM_ZERO
  Field before = own;
#else
  Field before = load(push.d, i);
#endif
  Row row = row_at(i, own);
  Field r = difference(Fields(push.b).at[i], row_times(slot, row));
  Field d = add_scaled(scaled(vec3(push.c1), before), vec3(push.c2), solved(diagonal_of(row), r));
  store(push.d, i, d);
  store(push.y, i, add(own, d));
}
