#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "material/optics.h"
#include "solver/stored_rows.glsl"
#include "shared/reduce.glsl"
#include "solver/convergence.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// `steps` of Chebyshev's iteration for A z = f from 0, preconditioned by a majorant M of A (majorant.comp), for the
// eigenvalues from `ratio` to 1, by one workgroup. Even `steps`: z ends in z. `reduce` as above.
struct CoarseSolvePush {
  RowsRef rows;
  Fields f;
  CoherentFields z;
  CoherentFields other;
  CoherentFields d;
  Entries majorant;
  SolveStates state;
  uint count;
  uint steps;
  uint reduce;
  float ratio;
};
layout(push_constant, scalar) uniform Block { CoarseSolvePush push; };

Field residual_at(CoherentFields x, Entry row_sum, uint i) {
  uint slice = i / SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  Field own = x.at[i];
  Field sum = times(row_sum, own);
  for (uint e = push.rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    StoredEntry stored = stored_entry(push.rows, e);
    sum = add(sum, times(entry_in(stored), difference(x.at[column_of(stored)], own)));
  }
  return difference(push.f.at[i], sum);
}

// One step on all rows; the writes are seen by all before the next.
void iterate(CoherentFields from, CoherentFields to, bool zero, float keep, float add_share) {
  for (uint i = gl_LocalInvocationID.x; i < push.count; i += WORKGROUP_SIZE) {
    Field r;
    if (zero) {
      r = push.f.at[i];
    } else {
      r = residual_at(from, load_row(push.rows, i).sum, i);
    }
    Field d = scaled(vec3(add_share), times(push.majorant.at[i], r));
    if (!zero) d = add_scaled(d, vec3(keep), push.d.at[i]);
    push.d.at[i] = d;
    if (zero) {
      to.at[i] = d;
    } else {
      to.at[i] = add(from.at[i], d);
    }
  }
  memoryBarrierBuffer();
  barrier();
}

void main() {
  float middle = 0.5 * (1.0 + push.ratio), radius = 0.5 * (1.0 - push.ratio);
  float rho = radius / middle;
  iterate(push.z, push.other, true, 0.0, 1.0 / middle);
  for (uint k = 1u; k < push.steps; ++k) {
    float next = 1.0 / (2.0 * middle / radius - rho);
    bool odd = k % 2u == 1u;
    CoherentFields from = push.z, to = push.other;
    if (odd) {
      from = push.other;
      to = push.z;
    }
    iterate(from, to, false, next * rho, 2.0 * next / radius);
    rho = next;
  }
  if (push.reduce == 0u) return;
  vec3 own = vec3(0);
  for (uint i = gl_LocalInvocationID.x; i < push.count; i += WORKGROUP_SIZE) {
    own += product(push.f.at[i], push.z.at[i]);
  }
  vec3 rz = reduce_workgroup(own);
  if (gl_LocalInvocationID.x == 0u) take_preconditioned(push.state, rz);
}
