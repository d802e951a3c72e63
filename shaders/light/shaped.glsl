// What passes know of: lights with a shape, a roughness that varies, normals by an image.
#ifndef QUADGRAPH_SHAPED_GLSL
#define QUADGRAPH_SHAPED_GLSL

#include "light/render_shared.h"

layout(constant_id = 1) const uint VARIANT = 0u;
const bool SHAPED = (VARIANT & VARIANT_SHAPED) != 0u;  // some light has a shape (LIGHT_FIRST_SHAPED)
const bool PLACED_ROUGHNESS = (VARIANT & VARIANT_PLACED_ROUGHNESS) != 0u;  // an image says where it is another
const bool NORMAL_MAP = (VARIANT & VARIANT_NORMAL_MAP) != 0u;  // an image says how the surface leans

// The shape of a light that has none.
LightShape no_shape() {
  LightShape shape;
  shape.more_follow = 0u;
  shape.parts = 1u;
  return shape;
}

#endif
