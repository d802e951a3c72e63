#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "solver/fields.glsl"
#include "material/optics.h"
#include "solver/stored_rows.glsl"
#include "shared/stride.glsl"
#define REDUCE(a, b) max(a, b)
#define REDUCE_ZERO vec3(0)
#include "shared/reduce.glsl"

// damping = 2 / bound of the eigenvalues of D^-1 A, per channel: the largest step of a
// relaxation that cannot diverge. With N = |D^-1 A| entry by entry and any y > 0, z = N y, the largest z_i / y_i is
// such a bound (Collatz 1942, Wielandt 1950); z as the next y gives a better one. `first`: y = 1, without reading it.
struct EigenvalueBoundPush {
  RowsRef rows;
  Fields y;
  Fields z;
  Vec3s damping;
  Reduction reduction;
  uint count;
  uint first;
};
layout(push_constant, scalar) uniform Block { EigenvalueBoundPush push; };

// What linear tetrahedra never exceed: no eigenvalue of an element's D^-1 K is above its trace.
const float ELEMENT_BOUND = 4.0;

// |D^-1 a| y, entry by entry.
Field magnitude_times(Entry diagonal, Entry a, Field y) {
#if MOMENTS == 1
  return Field(abs(a.a11 / diagonal.a11) * y.phi);
#else
  Field first = solved(diagonal, Field(a.a11, a.a12)), second = solved(diagonal, Field(a.a12, a.a22));
  return Field(abs(first.phi) * y.phi + abs(second.phi) * y.phi2, abs(first.phi2) * y.phi + abs(second.phi2) * y.phi2);
#endif
}

Field one() {
#if MOMENTS == 1
  return Field(vec3(1));
#else
  return Field(vec3(1), vec3(1));
#endif
}

Field start_or(Fields y, uint i) {
  if (push.first == 1u) return one();
  return y.at[i];
}

vec3 largest_ratio(Field z, Field y) {
#if MOMENTS == 1
  return z.phi / y.phi;
#else
  return max(z.phi / y.phi, z.phi2 / y.phi2);
#endif
}

void main() {
  vec3 own = vec3(0);
  EACH(i, push.count) {
    uint slice = i / SLICE_ROWS;
    uint end = push.rows.slice_offset.at[slice + 1u];
    Row row = load_row(push.rows, i);
    Field y = start_or(push.y, i);
    Entry diagonal = row.sum;  // of A; D may be rounded otherwise
    Field z = no_field();
    for (uint e = push.rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
      StoredEntry stored = stored_entry(push.rows, e);
      Entry entry = entry_in(stored);
      diagonal = difference_of(diagonal, entry);
      z = add(z, magnitude_times(row.diagonal, entry, start_or(push.y, column_of(stored))));
    }
    z = add(z, magnitude_times(row.diagonal, diagonal, y));
    push.z.at[i] = z;
    own = max(own, largest_ratio(z, y));
  }
  vec3 largest;
  if (!reduce_dispatch(push.reduction, own, largest)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  vec3 before = vec3(ELEMENT_BOUND);
  if (push.first == 0u) before = 2.0 / push.damping.at[0];
  push.damping.at[0] = 2.0 / min(before, largest);
}
