// What the passes of the solve share with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_SOLVE_SHARED_H
#define QUADGRAPH_SOLVE_SHARED_H

#include "shared/beam_shared.h"
#include "shared/refraction.h"

// Rows per slice of an operator (sliced ELL): neighbouring invocations read neighbouring entries, and a row is padded
// only to the longest of its slice. 32 is the width of the widest common subgroup; a processor has no neighbours.
#ifdef QG_PROCESSOR
#define SLICE_ROWS 1
#else
#define SLICE_ROWS 32
#endif

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
QG_COHERENT_ARRAY(CoherentFields, Field);

#endif

// K of engine/optics/boundary.h, and what the diffuse source needs.
struct Boundary {
  float k11, k12, k22;
  float source, reflected;
};
#ifndef __cplusplus
QG_ARRAY(Boundaries, Boundary);

#endif

// Operator rows of one level, method and model, without the right-hand side: with a_e and j_e, weight and column of
// entry e (packing.h),
//   (A x)_i = row_sum_i x_i + sum_e a_e (x_j_e - x_i)
// over e = slice_offset[i / SLICE_ROWS] + i % SLICE_ROWS, in steps of SLICE_ROWS, to the next slice. Padding entries
// name their own row with weight 0. Taking differences, the stiffness, which is all that a fine mesh's large entries
// consist of, cancels before it is rounded: the flux from i to j is that from j to i, and energy is kept in single
// precision. `diagonal` = row_sum - sum of the weights is for preconditioning. Both are read with stored_rows.glsl:
// with packed entries of SP3 they are one array.
struct RowsRef {
  QG_REF(Uints) slice_offset;
  QG_REF(Uints) entry;
  QG_REF(Entries) row_sum;
  QG_REF(Entries) diagonal;
};

// What a tet of a deformed body counts for at least (tet_volume.glsl); 0 in both: every tet counts for what it is.
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

// State of the solve of one level. `difference`, `change` and `algebraic` are of the exitance, as area-weighted RMS
// over the whole surface (x), over its unlit part (y) and over its dimmest third (z), channels together.
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
  vec3 change;      // of the last iterations, relative
  vec3 algebraic;   // estimated error that is left, relative; below 0: not known yet
  vec3 difference;  // from the exitance of the start, relative
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

#endif

// Where the right-hand side of a level's rows goes (right_hand_side.glsl): b, and its norm in `state`.
struct RightHandSideRef {
  QG_REF(Entries) diagonal;  // of the rows
  QG_REF(Fields) b;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
};

const uint START_FIRST = 0u;     // resets the state, opens the gates
const uint START_AGAIN = 3u;     // the same within a solve: iterations done so far are kept as earlier ones
const uint START_CHECK = 1u;     // after the surface has met the tolerance: does the residual agree?
const uint START_RESIDUAL = 2u;  // no decision

// Rows of barycentric transfers, which cycles use, have so many entries (engine/file/graph.h).
const uint BARYCENTRIC_WIDTH = 4u;

// An entry of a column of a transfer.
struct TransposedEntry {
  uint row;
  float weight;
};
#ifndef __cplusplus
QG_ARRAY(TransposedEntries, TransposedEntry);
#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
