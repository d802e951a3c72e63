// Whether lights of a pass have a shape.
#ifndef QUADGRAPH_SHAPED_GLSL
#define QUADGRAPH_SHAPED_GLSL

#include "light/render_shared.h"

layout(constant_id = 1) const uint VARIANT = 0u;
const bool SHAPED = VARIANT != 0u;  // some light has a shape (LIGHT_FIRST_SHAPED)

// The shape of a light that has none.
LightShape no_shape() {
  LightShape shape;
  shape.more_follow = 0u;
  shape.parts = 1u;
  return shape;
}

#endif
