// What the passes of the transport correction share with C++, in scalar layout; see shared.h. Equations:
// docs/physics.md, "Transport correction". All light is in units of the scale.
#ifndef QUADGRAPH_TRANSPORT_SHARED_H
#define QUADGRAPH_TRANSPORT_SHARED_H

#include "shared/body_shared.h"
#include "solver/solve_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Samples come in two halves, each an estimate of its own: what both agree on is no noise.
const uint TRANSPORT_HALVES = 2u;

// What a point stands for falls with the mean free paths d below the surface, as e^-d + TRANSPORT_FLOOR: deep light
// matters to what leaves in thick bodies alone, but there it does.
const float TRANSPORT_FLOOR = 0.03f;

// A ray that keeps less than this goes on by chance, with this weight.
const float TRANSPORT_ROULETTE = 0.03f;

// Where the transport equation is evaluated inside the body.
struct TransportPoint {
  uint tet;
  uint seed;
  uint half_of;  // the half that it counts for
  float volume;  // mm^3 that it stands for
};

// What rays see: the body, fluence at its vertices, and at the corners of each tet the power per volume that light
// scatters there for the first time.
struct TransportFieldRef {
  BodyRef body;
  QG_REF(Vec3s) fluence;   // W/mm^2
  QG_REF(Vec3s) first;     // W/mm^3, four per tet
  QG_REF(Uints) segments;  // tets crossed by all rays so far, one
};

// Area-weighted squares over the whole surface (x) and over its unlit part (y), channels together.
struct TransportChange {
  vec2 change;  // product of what both halves have changed the exitance by: without their noise
  vec2 noise;   // of half the difference between the halves
  vec2 size;    // of the exitance
};

#ifndef __cplusplus
QG_ARRAY(TransportFieldRefs, TransportFieldRef);
QG_ARRAY(TransportChanges, TransportChange);
QG_ARRAY(TransportPoints, TransportPoint);

#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
