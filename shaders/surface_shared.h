// What the passes over the surface of a solution share with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_SURFACE_SHARED_H
#define QUADGRAPH_SURFACE_SHARED_H

#include "solve_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// What makes the exitance of the buried source positive: see clipping in exitance.comp.
struct Clip {
  vec3 factor;  // of all that is positive
  vec3 share;   // of the positive exitance that it gave up
};

// Sums of one workgroup of energy.comp.
struct EnergySums {
  vec3 entered;   // W
  vec3 exitance;  // W
  vec3 absorbed;  // W
  // Area-weighted squares, scaled, channels together: (M - M_coarse)^2, M^2, and both over faces with q = 0.
  vec4 error;
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
  QG_REF(Vec3s) coarse_exitance;
  QG_REF(Scales) scale;
  QG_REF(Clips) clip;
  QG_REF(EnergySumsArray) sums;
  uint tet_count;
  uint face_count;
  uint fem;
  uint even;  // 1: optical is the same everywhere
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
