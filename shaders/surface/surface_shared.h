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

// exitance.comp: phi and M = k11 phi + k12 phi2 - reflected q per outside face, 0 at reflecting ones. fem: the mean
// over the face's vertices; graph methods: the surface node, x at tet_count + face. With `clipped` 1 negative values at
// vertices or nodes count as 0, and the factor is found that restores the power.
struct ExitancePush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_kinds;
  QG_REF(Fields) x;
  QG_REF(Vec3s) to_phi;
  QG_REF(Vec3s) q;
  QG_REF(Scales) scale;
  QG_REF(Vec3s) phi;
  QG_REF(Vec3s) exitance;
  QG_REF(Clips) clip;
  QG_REF(Reduction) reduction;
  uint count;
  uint tet_count;
  uint fem;  // 1: fem, 0: graph methods
  uint clipped;
  Boundary boundary;
};

// vertex_exitance.comp: the area-weighted mean over the open faces around every surface vertex, 0 without any.
struct VertexExitancePush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_offset;
  QG_REF(Uints) face_incidence;
  QG_REF(Vec3s) face_exitance;
  QG_REF(Vec3s) exitance;
  uint count;
  uint geometric;  // 1: geometric mean, 0: arithmetic
};

// display_scale.comp: the factor that gives the exitance at vertices, linear over the faces, the power of the faces.
struct DisplayScalePush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_kinds;
  QG_REF(Vec3s) exitance;
  QG_REF(Vec3s) vertex_exitance;
  QG_REF(Scales) scale;
  QG_REF(Vec3s) factor;
  QG_REF(Reduction) reduction;
  uint count;
};

// energy.comp: sums per workgroup over faces and tets; applies the factor of the clip to the exitance of the faces.
struct EnergyPush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec4s) tets;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_kinds;
  QG_REF(Opticals) optical;
  QG_REF(Fields) x;
  QG_REF(Vec3s) to_phi;
  QG_REF(Vec3s) q;
  QG_REF(Vec3s) exitance;
  QG_REF(Scales) scale;
  QG_REF(Clips) clip;
  QG_REF(EnergySumsArray) sums;
  uint tet_count;
  uint face_count;
  uint fem;
  uint even;  // 1: optical is the same everywhere
  LeastTet least;
};

// energy_total.comp: one workgroup; total[i] = sum of sums[i], sums[i + WORKGROUP_SIZE], ...
struct EnergyTotalPush {
  QG_REF(EnergySumsArray) sums;
  QG_REF(EnergySumsArray) total;
  uint count;
};

// What a carrier on the surface stands for.
struct SurfaceShare {
  vec2 area;       // mm^2: all of it, and what is unlit
  vec3 reflected;  // W/mm^2: what the diffuse source reflects there, which is no part of the exitance
};
#ifndef __cplusplus
QG_ARRAY(SurfaceShares, SurfaceShare);

SurfaceShare load_surface_share(SurfaceShares a, uint i) {
  if (TEXELS) {
    uint t = texel_of(uvec2(a)) + 5u * i;
    return SurfaceShare(uintBitsToFloat(texels2(t)), uintBitsToFloat(texels3(t + 2u)));
  }
  return a.at[i];
}
#endif

// surface_share.comp: fem: the first `count` vertices, each with a third of its open faces; graph methods: the surface
// nodes.
struct SurfaceSharePush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_kinds;
  QG_REF(Uints) face_offset;
  QG_REF(Uints) face_incidence;
  QG_REF(Vec3s) q;
  QG_REF(Scales) scale;
  QG_REF(SurfaceShares) share;
  uint count;
  uint fem;
  float reflected;  // of q
};

const uint SURFACE_STORE = 0u;       // before = M
const uint SURFACE_CHANGE = 1u;      // change of M since `before`, then before = M; decides whether to go on
const uint SURFACE_DIFFERENCE = 2u;  // difference of M from `before`

// surface_change.comp: M of the carriers on the surface, `count` from `first` on, in units of the scale.
struct SurfaceChangePush {
  QG_REF(Fields) x;
  QG_REF(Vec3s) to_phi;
  QG_REF(SurfaceShares) share;
  QG_REF(Vec3s) before;
  QG_REF(Scales) scale;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint first;
  uint count;
  uint what;         // SURFACE_*
  uint level;        // whose gate opens the check
  uint verify;       // 1: the true residual has the last word
  uint stall_limit;  // looks in a row at which the residual has hardly fallen; 0: any number
  uint max_iterations;
  uint looks;        // from this one on the estimate counts
  uint by_change;    // 1: the rate is that of the changes where it is the larger one
  float least_rate;  // by which a residual is taken to fall from look to look
  float slow_rate;   // at which it has hardly fallen
  uint by_residual;  // 1: the residual has to be below the tolerance, too
  float tolerance;
  Boundary boundary;
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
