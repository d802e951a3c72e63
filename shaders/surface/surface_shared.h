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
};
#ifndef __cplusplus
QG_ARRAY(SurfaceShares, SurfaceShare);

#endif

// The exitance of a surface that is coarse for its material, on its way to be made even.
struct EvenRef {
  QG_REF(Vec3s) vertices;  // mm
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_tets;
  QG_REF(Opticals) optical;  // per tet
  QG_REF(Vec3s) q;           // W/mm^2
  QG_REF(Vec3s) exitance;    // W/mm^2
  float kept;                // share of diffuse light inside that the surface reflects back
  uint even;                 // 1: optical is the same everywhere
};

const uint SURFACE_STORE = 0u;       // before = M
const uint SURFACE_CHANGE = 1u;      // change of M since `before`, then before = M; decides whether to go on
const uint SURFACE_DIFFERENCE = 2u;  // difference of M from `before`

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
