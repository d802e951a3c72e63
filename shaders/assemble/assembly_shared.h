// What the passes that fill an operator and its right-hand side share with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_ASSEMBLY_SHARED_H
#define QUADGRAPH_ASSEMBLY_SHARED_H

#include "solver/solve_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// assemble_fdm.comp: weight, diagonal and to_phi of engine/reference/operator.h, one invocation per node.
struct AssembleFdmPush {
  RowsRef rows;
  QG_REF(Vec3s) nodes;
  QG_REF(Opticals) optical;
  QG_REF(Vec3s) to_phi;
  QG_REF(Uints) face_kinds;
  uint count;      // nodes
  uint tet_count;  // inner nodes
  Boundary boundary;
};

// assemble_fv.comp: weight, diagonal and to_phi, one invocation per node.
struct AssembleFvPush {
  RowsRef rows;
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec4s) tets;
  QG_REF(Uvec4s) links;
  QG_REF(Vec3s) nodes;
  QG_REF(Opticals) optical;
  QG_REF(Vec3s) to_phi;
  QG_REF(Uints) face_kinds;
  uint count;      // nodes
  uint tet_count;  // inner nodes
  LeastTet least;
  Boundary boundary;
};

// grid_material.comp: the mean coefficients of the tets around each vertex, by volume, and a fourth of that, mm^3.
struct GridMaterialPush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec4s) tets;
  QG_REF(Opticals) optical;  // of the tets
  QG_REF(AssemblyUints) tet_offset;
  QG_REF(AssemblyUints) tet_incidence;
  QG_REF(Opticals) vertex_optical;
  QG_REF(AssemblyFloats) volume;
  uint count;  // vertices
  uint even;   // 1: the coefficients are the same everywhere
  LeastTet least;
};

// assemble_polygrid.comp: weight, diagonal and to_phi, one invocation per vertex. Entry k of a row is link k.
struct AssemblePolygridPush {
  RowsRef rows;
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_offset;
  QG_REF(Uints) face_incidence;
  QG_REF(Opticals) optical;  // of the vertices
  QG_REF(AssemblyFloats) volume;
  QG_REF(Vec3s) to_phi;
  uint count;          // vertices
  uint surface_count;  // of them on the surface
  uint published;      // 1: differences of kappa phi, 0: of the flux
  Boundary boundary;
};

// Floats of a tet's shape: grad l_i . grad l_j V of its edges 01, 02, 03, 12, 13, 23 (mm), and its volume (mm^3).
const uint TET_SHAPE = 7u;

// shape.comp: measures every tet and outside face.
struct ShapePush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec4s) tets;
  QG_REF(Uvec3s) faces;
  QG_REF(AssemblyFloats) tet_shape;
  QG_REF(AssemblyFloats) face_area;  // mm^2
  uint tet_count;
  uint face_count;
  LeastTet least;
};

// assemble_even.comp: weight, row_sum and diagonal where the coefficients are the same everywhere, one invocation per
// vertex. What entries and rows are made of is that of row_structure.h, FemShape; entries from `area_count` on have no
// area.
struct AssembleEvenPush {
  RowsRef rows;
  QG_REF(Opticals) optical;  // one
  QG_REF(AssemblyVec2s) entry_shape;
  QG_REF(AssemblyFloats) entry_area;
  QG_REF(AssemblyVec2s) row_shape;
  uint count;
  uint area_count;
  Boundary boundary;
};

// The elements around an edge: tet * 8 + edge of the tet, or face * 8 + RING_FACE.
const uint RING_FACE = 7u;

// assemble_edges.comp: weight, one invocation per edge, which has two entries. The elements around edge e are ring[k],
// k from ring_offset[e] to ring_offset[e + 1], tets first; reflecting faces are left out.
struct AssembleEdgesPush {
  RowsRef rows;
  QG_REF(Opticals) optical;
  QG_REF(AssemblyFloats) tet_shape;
  QG_REF(AssemblyFloats) face_area;
  QG_REF(AssemblyUvec2s) edge_entry;
  QG_REF(AssemblyUints) ring_offset;
  QG_REF(AssemblyUints) ring;
  uint count;
  uint even;  // 1: the coefficients are the same everywhere
  Boundary boundary;
};

// assemble_fem.comp: diagonal from the weights, one invocation per vertex. Its tets and open faces are incidence[k], k
// from offset[v] to offset[v + 1].
struct AssembleFemPush {
  RowsRef rows;
  QG_REF(Opticals) optical;
  QG_REF(AssemblyFloats) tet_shape;
  QG_REF(AssemblyFloats) face_area;
  QG_REF(AssemblyUints) tet_offset;
  QG_REF(AssemblyUints) tet_incidence;
  QG_REF(Uints) face_offset;
  QG_REF(Uints) face_incidence;
  uint count;
  uint surface_count;
  uint even;  // 1: the coefficients are the same everywhere
  Boundary boundary;
};

// irradiance_scale.comp: `scale` from the power that enters, per channel.
struct IrradianceScalePush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_kinds;
  QG_REF(Vec3s) q;
  QG_REF(Scales) scale;
  QG_REF(Reduction) reduction;
  uint count;
};

// right_hand_side_fdm.comp: scaled b at every node, and its norm.
struct RightHandSideFdmPush {
  QG_REF(Vec3s) nodes;
  QG_REF(Opticals) optical;
  QG_REF(Uints) face_tets;
  QG_REF(Uints) face_kinds;
  QG_REF(Vec3s) q;
  QG_REF(Scales) scale;
  QG_REF(Entries) diagonal;
  QG_REF(Fields) b;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  uint tet_count;
  Boundary boundary;
};

// right_hand_side_fv.comp: scaled b at every node, and its norm.
struct RightHandSideFvPush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_kinds;
  QG_REF(Vec3s) q;
  QG_REF(Scales) scale;
  QG_REF(Entries) diagonal;
  QG_REF(Fields) b;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  uint tet_count;
  Boundary boundary;
};

// right_hand_side_fem.comp: scaled b at every vertex, and its norm.
struct RightHandSideFemPush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_offset;
  QG_REF(Uints) face_incidence;
  QG_REF(Vec3s) q;
  QG_REF(Scales) scale;
  QG_REF(Entries) diagonal;
  QG_REF(Fields) b;
  QG_REF(SolveStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  uint surface_count;
  Boundary boundary;
};

// eigenvalue_bound.comp: damping = 2 / bound of the eigenvalues of D^-1 A, per channel: the largest step of a
// relaxation that cannot diverge. With N = |D^-1 A| entry by entry and any y > 0, z = N y, the largest z_i / y_i is
// such a bound (Collatz 1942, Wielandt 1950); z as the next y gives a better one. `first`: y = 1, without reading it.
struct EigenvalueBoundPush {
  RowsRef rows;
  QG_REF(Fields) y;
  QG_REF(Fields) z;
  QG_REF(Vec3s) damping;
  QG_REF(Reduction) reduction;
  uint count;
  uint first;
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
