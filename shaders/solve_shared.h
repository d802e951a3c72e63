// What the passes of the solve share with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_SOLVE_SHARED_H
#define QUADGRAPH_SOLVE_SHARED_H

#include "shared.h"

// Rows per slice of an operator (sliced ELL): neighbouring invocations read neighbouring entries, and a row is padded
// only to the longest of its slice. 32 is the width of the widest common subgroup.
#define SLICE_ROWS 32

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Unknowns of one carrier and entries of an operator (engine/graph/block.h). Every pass that touches them is compiled
// twice: with MOMENTS 1 for diffusion, which has phi and a11 alone, and with MOMENTS 2 for SP3.
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
#endif

// K of engine/graph/boundary.h, and what the diffuse source needs.
struct Boundary {
  float k11, k12, k22;
  float source, reflected;
};

// Operator rows of one level, method and model, without the right-hand side: with a_e = weight_e and j_e = column_e,
//   (A x)_i = row_sum_i x_i + sum_e a_e (x_j_e - x_i)
// over e = slice_offset[i / SLICE_ROWS] + i % SLICE_ROWS, in steps of SLICE_ROWS, to the next slice. Padding entries
// name their own row with weight 0. Taking differences, the stiffness, which is all that a fine mesh's large entries
// consist of, cancels before it is rounded: the flux from i to j is that from j to i, and energy is kept in single
// precision. `diagonal` = row_sum - sum of the weights is for preconditioning.
struct RowsRef {
  QG_REF(Uints) slice_offset;
  QG_REF(Uints) column;
  QG_REF(Entries) weight;
  QG_REF(Entries) row_sum;
  QG_REF(Entries) diagonal;
};

// Kinds of outside faces (engine/graph/graph.h).
const uint FACE_OPEN = 0u;
const uint FACE_REFLECTING = 1u;

const uint BEAM_DIRECTIONAL = 0u;
const uint BEAM_POINT = 1u;
const uint BEAM_LAMBERTIAN = 2u;
const uint BEAM_MEAN = 3u;

// How the light of one source comes in, wherever it does.
struct BeamRecord {
  uint kind;    // BEAM_*
  vec3 vector;  // directional: unit, the way the light travels; point: where it comes from, mm; others: unused
};

// How much of a beam is stored per face, floats: one or one per quarter, to be multiplied by its colour; or q itself.
const uint BEAM_FACE = 1u;
const uint BEAM_QUARTERS = FACE_QUARTERS;
const uint BEAM_RGB = 3u;

// A beam as the faces of all levels see it (beam_light.glsl).
struct Beam {
  BeamRecord way;
  vec3 colour;  // W/mm^2 of what is stored as 1
  uint floats;  // BEAM_FACE, BEAM_QUARTERS or BEAM_RGB
  uint offset;  // floats of the beams before it, per face
};

// Rays of a Lambertian beam from one origin: at outside cosine sqrt(u), u the four Gauss-Legendre nodes on [0, 1], two
// antipodal azimuths each, turned by 90 degrees from node to node so that no direction is preferred. Each node has
// weight w T(sqrt(u)), T the Fresnel transmittance, normalised to 1.
const uint LAMBERTIAN_NODES = 4u;
const float LAMBERTIAN_U[4] = {0.0694318442f, 0.3300094782f, 0.6699905218f, 0.9305681558f};
const float LAMBERTIAN_W[4] = {0.1739274226f, 0.3260725774f, 0.3260725774f, 0.1739274226f};

// BEAM_MEAN is even light by one ray from an origin, at the mean inside cosine of those of a Lambertian beam: for light
// that re-enters, bounce after bounce. On face f it has the azimuth (f GOLDEN_TURN mod 2^32) / 2^32 turns, from the
// face's first edge t1 towards normal x t1. The golden ratio's fraction in units of 2^-32: integers turn alike on CPU
// and GPU.
const uint GOLDEN_TURN = 2654435769u;

// A ray ends where each channel has kept less than this share of its power, and what is left stays there.
const float WALK_END = 1e-4f;
// Tets that a ray crosses at most: light trapped by total reflection in a clear body ends here. Four such rays of one
// invocation stay below the 65535 turns after which lavapipe leaves all loops.
const uint MAX_WALK_STEPS = 4096u;

const uint SOLVE_RUNNING = 0u;
const uint SOLVE_CONVERGED = 1u;
const uint SOLVE_STAGNATED = 2u;     // single precision allows no smaller residual
const uint SOLVE_EXHAUSTED = 3u;     // iteration limit reached
const uint SOLVE_NOT_POSITIVE = 4u;  // p^T A p <= 0
const uint SOLVE_NOT_FINITE = 5u;    // overflow or NaN
const uint SOLVE_DIVERGED = 6u;      // relaxation grows

// State of the solve of one level; the residual of a channel is sqrt(rz / norm).
struct SolveState {
  uvec3 iterate;    // indirect workgroup counts of the next iteration; zero when it is not wanted
  uvec3 check;      // of the pass that computes the true residual
  vec3 norm;        // b^T D^-1 b
  vec3 rz;          // r^T D^-1 r
  vec3 alpha;       // step along p; 0 in a channel that has converged
  vec3 beta;        // share of the old direction
  float residual;   // worst channel
  float checked;    // worst channel, at the last computation of the true residual
  uint iterations;  // done
  uint status;      // SOLVE_*
  uint channel;     // that failed
};

// Powers of two, at least the power that enters: so squares neither overflow nor vanish, and shares of it fit in fixed
// point.
struct Scale {
  vec3 scale;    // W, or W/mm^2; in a channel without light that of the brightest, and 1 without any
  vec3 inverse;  // 1/W, or mm^2/W
};

#ifndef __cplusplus
QG_ARRAY(Beams, Beam);
QG_ARRAY(SolveStates, SolveState);
QG_ARRAY(Scales, Scale);
#endif

// transfer.comp: x = sum of weight * to_phi_coarse * x_coarse / to_phi, for `count` rows from `first` on; 0 in a
// channel without light.
struct TransferPush {
  QG_REF(Uints) index;
  QG_REF(Floats) weight;
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

// cg_start.comp: r = b - A x, p = r / D; decides whether to iterate. `first` resets the state.
struct CgStartPush {
  RowsRef rows;
  QG_REF(Fields) b;
  QG_REF(Fields) x;
  QG_REF(Fields) r;
  QG_REF(Fields) p;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  uint max_iterations;
  float tolerance;
  uint first;
};

// cg_multiply.comp: product = A p, alpha.
struct CgMultiplyPush {
  RowsRef rows;
  QG_REF(Fields) p;
  QG_REF(Fields) product;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  float tolerance;
};

// cg_update.comp: x += alpha p, r -= alpha A p, beta; stops the iteration.
struct CgUpdatePush {
  QG_REF(Entries) diagonal;
  QG_REF(Fields) p;
  QG_REF(Fields) product;
  QG_REF(Fields) x;
  QG_REF(Fields) r;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  uint max_iterations;
  float tolerance;
};

// cg_direction.comp: p = r / D + beta p.
struct CgDirectionPush {
  QG_REF(Entries) diagonal;
  QG_REF(Fields) r;
  QG_REF(Fields) p;
  QG_REF(SolveStates) state;
  uint count;
};

// sweep.comp: to = from + damping (b - A from) / D. With `sweeps` > 0 it also takes the residual of `from`, counts that
// many sweeps as done and stops the relaxation if it can.
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
  float tolerance;
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
