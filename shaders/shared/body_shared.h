// The tets of a level as rays see them (tet_ray.glsl), shared with C++ in scalar layout; see shared.h.
#ifndef QUADGRAPH_BODY_SHARED_H
#define QUADGRAPH_BODY_SHARED_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// A crossing, out of the face opposite corner k of a tet: (the tet across, or tet_count + face) << CROSSING_BITS | for
// each corner j < 3 two bits from 2 j on: its place in the tet across, for k that of the new vertex. The place of
// corner 3 is the one that is left.
#define CROSSING_BITS 6

const uint BODY_EVEN = 1u;      // the coefficients are the same everywhere
const uint BODY_INVERTED = 2u;  // some tets are turned inside out: rays end there

struct BodyRef {
  QG_REF(Vec3s) vertices;  // mm
  QG_REF(Uvec4s) tets;
  QG_REF(Uints) crossings;  // four per tet
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_tets;
  QG_REF(Uints) face_kinds;
  QG_REF(Opticals) optical;  // per tet
  uint tet_count;
  uint face_count;
  uint flags;  // BODY_*
  float eta;
};

// Around the faces of a node of the tree, mm.
struct Box {
  vec3 low, high;
};

#ifndef __cplusplus
QG_ARRAY(Boxes, Box);

Box load_box(Boxes a, uint i) {
  if (TEXELS) return Box(load_vec3(Vec3s(uvec2(a)), 2u * i), load_vec3(Vec3s(uvec2(a)), 2u * i + 1u));
  return a.at[i];
}
#endif

// A tree over outside faces (engine/file/face_tree.h).
struct TreeRef {
  QG_REF(Uints) order;
  QG_REF(Uints) leaf_begin;
  QG_REF(Boxes) boxes;  // by node
  uint leaf_count;
};

// A body, and the tree over its faces.
struct SolidRef {
  BodyRef body;
  TreeRef tree;
};

#ifndef __cplusplus
QG_ARRAY(BodyRefs, BodyRef);
QG_ARRAY(SolidRefs, SolidRef);

BodyRef body_in_texels(uint t) {
  return BodyRef(Vec3s(texels2(t)), Uvec4s(texels2(t + 2u)), Uints(texels2(t + 4u)), Uvec3s(texels2(t + 6u)),
                 Uints(texels2(t + 8u)), Uints(texels2(t + 10u)), Opticals(texels2(t + 12u)), texel(t + 14u),
                 texel(t + 15u), texel(t + 16u), uintBitsToFloat(texel(t + 17u)));
}

// The only one of an array.
BodyRef load_body(BodyRefs a) {
  if (TEXELS) return body_in_texels(texel_of(uvec2(a)));
  return a.at[0];
}

TreeRef tree_in_texels(uint t) {
  return TreeRef(Uints(texels2(t)), Uints(texels2(t + 2u)), Boxes(texels2(t + 4u)), texel(t + 6u));
}

SolidRef solid_in_texels(uint t) {
  return SolidRef(body_in_texels(t), tree_in_texels(t + 18u));
}

// The only one of an array.
SolidRef load_solid(SolidRefs a) {
  if (TEXELS) return solid_in_texels(texel_of(uvec2(a)));
  return a.at[0];
}
#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
