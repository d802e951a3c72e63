// The tets of a level as rays see them (tet_ray.glsl), shared with C++ in scalar layout; see shared.h.
#ifndef QUADGRAPH_BODY_SHARED_H
#define QUADGRAPH_BODY_SHARED_H

#include "shared/forward_scattering.h"
#include "shared/refraction.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// A crossing, out of the face opposite corner k of a tet: (the tet across, or tet_count + face) << CROSSING_BITS | for
// each corner j < 3 two bits from 2 j on: its place in the tet across, for k that of the new vertex. The place of
// corner 3 is the one that is left.
#define CROSSING_BITS 6

// Of ForwardLight: first the flux, then the direction.
const uint GATHER_FLOWS = 6u;

const uint BODY_EVEN = 1u;  // the coefficients are the same everywhere

// A tet as rays see it, in one line of a cache: how the barycentric coordinates grow along x, y and z, 1/mm, by corner,
// and what lies across the face opposite each. Where rays are to end it grows along nothing.
struct TetCell {
  vec4 along_x, along_y, along_z;
  uvec4 crossings;
};

#ifndef __cplusplus
QG_ARRAY(TetCells, TetCell);

#endif

struct BodyRef {
  QG_REF(Vec3s) vertices;  // mm
  QG_REF(Uvec4s) tets;
  QG_REF(TetCells) cells;  // per tet
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_tets;
  QG_REF(Uints) face_kinds;
  QG_REF(Opticals) optical;      // per tet
  QG_REF(Floats) etendue;        // per tet (inner_surface.glsl); null: 1 everywhere
  QG_REF(Vec3s) shared_normals;  // per vertex, of surfaces that bodies share the unit normal; null where etendue is
  uint tet_count;
  uint face_count;
  uint flags;  // BODY_*
};

// Around the faces of a node of the tree, mm.
struct Box {
  vec3 low, high;
};

#ifndef __cplusplus
QG_ARRAY(Boxes, Box);

#endif

// A tree over outside faces (engine/file/face_tree.h).
struct TreeRef {
  QG_REF(Uints) order;
  QG_REF(Uints) leaf_begin;
  QG_REF(Boxes) boxes;  // by node
  uint leaf_count;
};

// Light at the vertices of a body that scatters forwards, by channel: along x, y and z three times what counts of the
// flux of scattered light, W/mm^2, and the mean direction of light that has not scattered, at most of length 1.
struct ForwardLight {
  QG_REF(Vec3s) flows;  // GATHER_FLOWS per vertex; null where light scatters evenly
  BesidePeak beside;
};

// A body, the tree over its faces, and the smooth surface that these stand for.
struct SolidRef {
  BodyRef body;
  TreeRef tree;
  QG_REF(Vec3s) normals;  // three per face, unit: at its corners
  ForwardLight forward;
};

#ifndef __cplusplus
QG_ARRAY(BodyRefs, BodyRef);
QG_ARRAY(SolidRefs, SolidRef);

#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
