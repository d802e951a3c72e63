// What the passes of the solve share with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_SOLVE_SHARED_H
#define QUADGRAPH_SOLVE_SHARED_H

#include "shared/beam_shared.h"

// Rows per slice of an operator (sliced ELL): neighbouring invocations read neighbouring entries, and a row is padded
// only to the longest of its slice. 32 is the width of the widest common subgroup.
#define SLICE_ROWS 32

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Unknowns of one carrier and entries of an operator (engine/reference/block.h). Every pass that touches them is
// compiled twice: with MOMENTS 1 for diffusion, which has phi and a11 alone, and with MOMENTS 2 for SP3.
#ifndef __cplusplus
#ifndef MOMENTS
#define MOMENTS 1
#endif
struct Field {
  vec3 phi;
#if MOMENTS == 2
  vec3 phi2;
#endif
};
struct Entry {
  vec3 a11;
#if MOMENTS == 2
  vec3 a12;
  vec3 a22;
#endif
};
QG_ARRAY(Fields, Field);
QG_ARRAY(Entries, Entry);
// Written by some invocations of a workgroup and read by others, in one dispatch.
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer CoherentFields {
  Field at[];
};

Field load_field(Fields a, uint i) {
  if (FIELD_TEXELS) {
#if MOMENTS == 1
    return Field(uintBitsToFloat(field_texels3(field_texel_of(uvec2(a)) + 3u * i)));
#else
    uint t = field_texel_of(uvec2(a)) + 6u * i;
    return Field(uintBitsToFloat(field_texels3(t)), uintBitsToFloat(field_texels3(t + 3u)));
#endif
  }
  return a.at[i];
}

Field load_coherent(CoherentFields a, uint i) {
  if (FIELD_TEXELS) return load_field(Fields(uvec2(a)), i);
  return a.at[i];
}

Entry load_block(Entries a, uint i) {
  if (ROW_TEXELS) {
#if MOMENTS == 1
    return Entry(uintBitsToFloat(row_texels3(row_texel_of(uvec2(a)) + 3u * i)));
#else
    uint t = row_texel_of(uvec2(a)) + 9u * i;
    return Entry(uintBitsToFloat(row_texels3(t)), uintBitsToFloat(row_texels3(t + 3u)),
                 uintBitsToFloat(row_texels3(t + 6u)));
#endif
  }
  return a.at[i];
}
#endif

// K of engine/optics/boundary.h, and what the diffuse source needs.
struct Boundary {
  float k11, k12, k22;
  float source, reflected;
};

// Operator rows of one level, method and model, without the right-hand side: with a_e and j_e, weight and column of
// entry e (packing.h),
//   (A x)_i = row_sum_i x_i + sum_e a_e (x_j_e - x_i)
// over e = slice_offset[i / SLICE_ROWS] + i % SLICE_ROWS, in steps of SLICE_ROWS, to the next slice. Padding entries
// name their own row with weight 0. Taking differences, the stiffness, which is all that a fine mesh's large entries
// consist of, cancels before it is rounded: the flux from i to j is that from j to i, and energy is kept in single
// precision. `diagonal` = row_sum - sum of the weights is for preconditioning. Both are read with stored_rows.glsl:
// with packed entries of SP3 they are one array.
struct RowsRef {
  QG_REF(RowUints) slice_offset;
  QG_REF(RowUints) entry;
  QG_REF(Entries) row_sum;
  QG_REF(Entries) diagonal;
};

// Kinds of outside faces (engine/file/graph.h).
const uint FACE_OPEN = 0u;
const uint FACE_REFLECTING = 1u;

// What a tet of a deformed body counts for at least (tet_volume.glsl); 0 in both: for what it is.
struct LeastTet {
  float quality;  // 1 of a regular tet, 0 of a flat one
  float volume;   // mm^3
};

// A ray ends where each channel has kept less than this share of its power, and what is left stays there.
const float WALK_END = 1e-4f;
// Tets that a ray crosses at most: light trapped by total reflection in a clear body ends here. Four such rays of one
// invocation stay below the 65535 turns after which lavapipe leaves all loops.
const uint MAX_WALK_STEPS = 4096u;

const uint SOLVE_RUNNING = 0u;
const uint SOLVE_CONVERGED = 1u;
const uint SOLVE_STAGNATED = 2u;     // single precision allows no smaller residual
const uint SOLVE_EXHAUSTED = 3u;     // iteration limit reached
const uint SOLVE_NOT_POSITIVE = 4u;  // p^T A p <= 0, or r^T B r <= 0 with the preconditioner B
const uint SOLVE_NOT_FINITE = 5u;    // overflow or NaN
const uint SOLVE_DIVERGED = 6u;      // relaxation grows
const uint SOLVE_STALLED = 7u;       // the residual hardly falls for too many cycles

// Levels that one solve works on at most; coarser ones of a file are left out.
#define MAX_LEVELS 12

// State of the solve of one level. `difference`, `change` and `algebraic` are of the exitance, as area-
// weighted RMS over the whole surface (x) and over its unlit part (y), channels together.
struct SolveState {
  uvec3 gate[MAX_LEVELS];   // indirect workgroup counts of the iteration's passes on each level; zero when not wanted
  uvec3 coarse;             // of its pass on the coarsest level, which is one workgroup
  uvec3 surface;            // of its pass over the surface
  uvec3 check;              // of the pass that computes the true residual
  uint groups[MAX_LEVELS];  // gates when open, x; 0 on levels finer than this one
  uint surface_groups;
  vec3 norm;        // b^T D^-1 b
  vec3 square;      // r^T D^-1 r; the residual of a channel is sqrt(square / norm)
  vec3 rz;          // r^T B r with the preconditioner B; 0 before the first iteration
  vec3 alpha;       // step along p; 0 in a channel that has converged
  vec3 beta;        // share of the old direction
  float residual;   // worst channel
  float checked;    // worst channel, at the last computation of the true residual
  uint iterations;  // done since the start
  uint earlier;     // done before it, since the first start of a solve
  uint status;      // SOLVE_*
  uint channel;     // that failed
  vec2 change;      // of the last iterations, relative
  vec2 algebraic;   // estimated error that is left, relative; below 0: not known yet
  vec2 difference;  // from the exitance of the start, relative
  float looked;     // residual at the last look at the surface
  uint looks;       // so far
  uint slow;        // of them in a row at which the residual had hardly fallen
  uint restarts;    // from the true residual, after it had been found larger than the recursive one
};

// Powers of two, at least the power that enters: so squares neither overflow nor vanish, and shares of it fit in fixed
// point.
struct Scale {
  vec3 scale;    // W, or W/mm^2; in a channel without light that of the brightest, and 1 without any
  vec3 inverse;  // 1/W, or mm^2/W
  float unlit;   // W/mm^2, sum of the channels: faces with less q count as unlit
};

#ifndef __cplusplus
QG_ARRAY(SolveStates, SolveState);
QG_ARRAY(Scales, Scale);

// The only one of an array.
Scale load_scale(Scales a) {
  if (TEXELS) {
    uint t = texel_of(uvec2(a));
    return Scale(uintBitsToFloat(texels3(t)), uintBitsToFloat(texels3(t + 3u)), uintBitsToFloat(texel(t + 6u)));
  }
  return a.at[0];
}
#endif

// transfer.comp: x = sum of weight * to_phi_coarse * x_coarse / to_phi (1 where null), for `count` rows from `first`
// on; 0 in a channel without light.
struct TransferPush {
  QG_REF(RowUints) index;
  QG_REF(RowFloats) weight;
  QG_REF(Fields) coarse_x;
  QG_REF(Vec3s) coarse_to_phi;
  QG_REF(Vec3s) to_phi;
  QG_REF(Fields) x;
  QG_REF(SolveStates) state;
  uint width;
  uint first;
  uint coarse_first;  // added to every index
  uint count;
};

// follow.comp: the last solution as the next start: before = x in the present units, x = before + transfer of what has
// changed on the coarser level since. `coarse_x` null: there is none. `before` null: no finer level will ask.
struct FollowPush {
  QG_REF(RowUints) index;
  QG_REF(RowFloats) weight;
  QG_REF(Fields) coarse_x;
  QG_REF(Fields) coarse_before;
  QG_REF(Vec3s) coarse_to_phi;
  QG_REF(Vec3s) to_phi;
  QG_REF(Fields) x;
  QG_REF(Fields) before;
  QG_REF(Vec3s) unit;  // one: the scale that x has
  QG_REF(Scales) scale;
  uint width;
  uint first;
  uint coarse_first;
  uint count;
  uint has_coarse;
  uint keep_before;
};

const uint START_FIRST = 0u;     // resets the state, opens the gates
const uint START_AGAIN = 3u;     // the same within a solve: iterations done so far are kept as earlier ones
const uint START_CHECK = 1u;     // after the surface has met the tolerance: does the residual agree?
const uint START_RESIDUAL = 2u;  // no decision

// cg_start.comp: r = b - A x and its norm; decides whether to iterate. Without multigrid also p = r / D.
struct CgStartPush {
  RowsRef rows;
  QG_REF(Fields) b;
  QG_REF(Fields) x;
  QG_REF(Fields) r;
  QG_REF(Fields) p;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  float tolerance;
  uint what;  // START_*
  uint multigrid;
};

// cg_multiply.comp: product = A p, alpha.
struct CgMultiplyPush {
  RowsRef rows;
  QG_REF(Fields) p;
  QG_REF(Fields) product;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
};

// cg_update.comp: x += alpha p, r -= alpha A p; without multigrid also beta.
struct CgUpdatePush {
  QG_REF(Entries) diagonal;
  QG_REF(Fields) p;
  QG_REF(Fields) product;
  QG_REF(Fields) x;
  QG_REF(Fields) r;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  uint multigrid;
};

// cg_direction.comp: p = z + beta p; without multigrid z = r / D.
struct CgDirectionPush {
  QG_REF(Entries) diagonal;
  QG_REF(Fields) r;
  QG_REF(Fields) z;
  QG_REF(Fields) p;
  QG_REF(SolveStates) state;
  uint count;
  uint multigrid;
};

// correct.comp: x += z, and counts the iteration.
struct CorrectPush {
  QG_REF(Fields) z;
  QG_REF(Fields) x;
  QG_REF(SolveStates) state;
  uint count;
};

// sweep.comp: to = from + damping (b - A from) / D. With `sweeps` > 0 it also takes the residual of `from`, counts that
// many sweeps as done and stops a relaxation that grows.
struct SweepPush {
  RowsRef rows;
  QG_REF(Fields) b;
  QG_REF(Fields) from;
  QG_REF(Fields) to;
  QG_REF(Vec3s) damping;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  uint sweeps;
};

// residual.comp: r = f - A x.
struct ResidualPush {
  RowsRef rows;
  QG_REF(Fields) f;
  QG_REF(Fields) x;
  QG_REF(Fields) r;
  uint count;
};

// chebyshev.comp: one step of Chebyshev's iteration for A x = f, preconditioned by D:
//   d <- keep d + add damping/2 D^-1 (f - A from),  to = from + d.
// `first`: d is not read. `zero`: from is 0 and not read. `last`: d is not written. With `zero` and without `last`, to
// is not written either: it would be d. `reduce`: also f^T to, for the direction.
struct ChebyshevPush {
  RowsRef rows;
  QG_REF(Fields) f;
  QG_REF(Fields) from;
  QG_REF(Fields) to;
  QG_REF(Fields) d;
  QG_REF(Vec3s) damping;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  uint first, zero, last, reduce;
  float keep;
  float add;
};

// coarse_solve.comp: `steps` of Chebyshev's iteration for A z = f from 0 on [ratio lambda, lambda], lambda = 2/damping,
// by one workgroup. Even `steps`: z ends in z. `reduce` as above.
struct CoarseSolvePush {
  RowsRef rows;
  QG_REF(Fields) f;
  QG_REF(CoherentFields) z;
  QG_REF(CoherentFields) other;
  QG_REF(CoherentFields) d;
  QG_REF(Vec3s) damping;
  QG_REF(SolveStates) state;
  uint count;
  uint steps;
  uint reduce;
  float ratio;
};

// Rows of barycentric transfers, which cycles use, have so many entries (engine/file/graph.h). llvmpipe divides by
// what it does not know lane by lane.
const uint BARYCENTRIC_WIDTH = 4u;

// restrict.comp: f_i = sum of weight_p r_(p / BARYCENTRIC_WIDTH), p = place_k, k from offset[i] to offset[i + 1]: the
// transpose of the transfer whose weights these are.
struct RestrictPush {
  QG_REF(RowUints) offset;
  QG_REF(RowUints) place;
  QG_REF(RowFloats) weight;
  QG_REF(Fields) r;
  QG_REF(Fields) f;
  uint count;
};

// prolong.comp: x += transfer of the coarse x.
struct ProlongPush {
  QG_REF(RowUints) index;
  QG_REF(RowFloats) weight;
  QG_REF(Fields) coarse_x;
  QG_REF(Fields) x;
  uint width;
  uint count;
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
