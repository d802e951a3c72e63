#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "solver/fields.glsl"
#include "material/optics.h"
#include "solver/stored_rows.glsl"
#include "shared/stride.glsl"

// M^-1 of a block-diagonal M with M - A positive semidefinite, so that no eigenvalue of M^-1 A is above 1: an entry a
// between two rows adds |a| = sqrt(a^2) to the blocks of both, as v^T |a| v + w^T |a| w + 2 v^T a w is never negative. For
// numbers these are the circles of Gershgorin. M is twice the diagonal where all entries are negative.
struct MajorantPush {
  RowsRef rows;
  Entries majorant;  // M^-1, written
  uint count;
};
layout(push_constant, scalar) uniform Block { MajorantPush push; };

Entry magnitude(Entry a) {
#if MOMENTS == 1
  return Entry(abs(a.a11));
#else
  // By Cayley and Hamilton, of eigenvalues with one sign and with two.
  vec3 trace = a.a11 + a.a22, determinant = a.a11 * a.a22 - a.a12 * a.a12;
  bvec3 one_sign = greaterThanEqual(determinant, vec3(0));
  vec3 sizes = sqrt(max(trace * trace - 4.0 * determinant, vec3(1e-37)));
  vec3 share = mix(trace / sizes, sign(trace), one_sign);
  vec3 rest = mix(-2.0 * determinant / sizes, vec3(0), one_sign);
  return Entry(share * a.a11 + rest, share * a.a12, share * a.a22 + rest);
#endif
}

// Of a positive definite entry; by elimination, as its determinant could leave the range of single precision.
Entry inverse_of(Entry a) {
#if MOMENTS == 1
  return Entry(1.0 / a.a11);
#else
  vec3 ratio = a.a12 / a.a11, last = 1.0 / (a.a22 - ratio * a.a12);
  return Entry(1.0 / a.a11 + ratio * ratio * last, -ratio * last, last);
#endif
}

void main() {
  EACH(i, push.count) {
    uint slice = i / SLICE_ROWS;
    uint end = push.rows.slice_offset.at[slice + 1u];
    Entry majorant = load_row(push.rows, i).sum;
    for (uint e = push.rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
      Entry entry = load_entry(push.rows, e);
      majorant = sum_of(majorant, difference_of(magnitude(entry), entry));
    }
    push.majorant.at[i] = inverse_of(majorant);
  }
}
