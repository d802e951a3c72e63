// What the passes over the surface of a solution share with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_SURFACE_SHARED_H
#define QUADGRAPH_SURFACE_SHARED_H

#include "solver/solve_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// What makes the exitance of the buried source positive: see clipping in exitance.comp.
struct Clip {
  vec3 factor;  // of all that is positive
  vec3 share;   // of the positive exitance that it gave up
};

const uint ENERGY_ON_VERTICES = 1u;  // the carriers are those of tets
const uint ENERGY_EVEN = 2u;         // the coefficients are the same everywhere

// Sums of one workgroup of energy.comp, and of energy_total.comp those of every WORKGROUP_SIZE-th of them.
struct EnergySums {
  vec3 entered;   // W
  vec3 exitance;  // W
  vec3 absorbed;  // W
};

#ifndef __cplusplus
QG_ARRAY(Clips, Clip);
QG_ARRAY(EnergySumsArray, EnergySums);
#endif

// What a carrier on the surface stands for.
struct SurfaceShare {
  vec3 area;       // mm^2: all of it, what is unlit, and what is of the dimmest third
  vec3 reflected;  // W/mm^2: what the diffuse source reflects there, which is no part of the exitance
  uint body;
};
#ifndef __cplusplus
QG_ARRAY(SurfaceShares, SurfaceShare);

#endif

// What of the exitance of a face is made even.
struct EvenFace {
  vec3 far;     // W/mm^2: all but light that comes out near where it went in
  vec3 share;   // of it that is made even
  vec3 normal;  // unit
  float area;   // mm^2
  uint lit;     // 1: light enters, 0: none does
};
#ifndef __cplusplus
QG_ARRAY(EvenFaces, EvenFace);

#endif

// A correction that is carried on as a factor at each face (carried_exitance.comp): what it may be at most, or one over
// that; the light, in the mean of the surface, beside which a face's own is little; and how much faster than its factor
// fades the light may change.
const float CARRIED_MOST = 3.0f;
const float CARRIED_LITTLE = 0.1f;
const float CARRIED_GAIN = 2.0f;

const uint SURFACE_STORE = 0u;       // before = M
const uint SURFACE_CHANGE = 1u;      // change of M since `before`, then before = M; decides whether to go on
const uint SURFACE_DIFFERENCE = 2u;  // difference of M from `before`

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
