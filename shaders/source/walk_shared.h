// What the walk of the buried source shares with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_WALK_SHARED_H
#define QUADGRAPH_WALK_SHARED_H

#include "shared/body_shared.h"
#include "solver/solve_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Power is added up in fixed point, so that the order of additions does not matter: 64 bits in units of the scale times
// this. Per element six u32: of each channel the low word, then the high one.
const float POWER_UNIT = 1.4210854715202004e-14f;  // 2^-46
#define FIXED_WORDS 6

// Per origin of a Lambertian beam.
const uint LAMBERTIAN_RAYS = 2u * LAMBERTIAN_NODES;

// Pairs of sums that the workgroups of a walk share: few to read back, many enough to be seldom waited for.
const uint WALK_SUMS = 256u;

// What adds up the light that is scattered for the first time.
const uint WALK_TETS = 0u;
const uint WALK_VERTICES = 1u;
const uint WALK_CORNERS = 2u;   // of each tet, four (transport_walk.comp)
const uint WALK_DEPOSITS = 3u;  // bits that say so; another may say that rays do not go on to WALK_END:
const uint WALK_TO_MEAN = 4u;   // to WALK_END_MEAN
const uint WALK_TO_AGAIN = 8u;  // to WALK_END_AGAIN
const uint WALK_ONE_RAY = 16u;  // and this that a Lambertian beam has one ray from an origin, not LAMBERTIAN_RAYS

// In place of WALK_END with mean rays (SolveOptions), where the albedo is above WALK_PALE. Light that enters again ends
// sooner than all other, as it is a small part.
const float WALK_END_MEAN = 0.01f;
const float WALK_END_AGAIN = 0.1f;
const float WALK_PALE = 0.9f;

// walk_source.comp: follows the rays of beams. One invocation per face and beam; of a Lambertian beam, one per face and
// ray of the bundle.
struct WalkSourcePush {
  QG_REF(BodyRefs) body;  // one
  QG_REF(Beams) beams;
  QG_REF(Floats) beam_q;  // of all
  QG_REF(Scales) scale;
  QG_REF(Uints) deposit;      // fixed point, per vertex, tet or corner of a tet: power scattered for the first time
  QG_REF(Uints) unscattered;  // fixed point, per face: power that leaves
  // Fixed point, WALK_SUMS times two: absorbed; left, or still under way at the end. Behind them WALK_SUMS plain
  // numbers: tets crossed.
  QG_REF(Uints) sums;
  uint beam_count;
  uint deposits;  // WALK_TETS or WALK_VERTICES, maybe WALK_ONE_RAY, and maybe where rays end
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
