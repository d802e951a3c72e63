// Whether passes know lights with a shape (LIGHT_FIRST_SHAPED).
#include "render_shared.h"

// 1 where some light has a shape (LIGHT_FIRST_SHAPED).
layout(constant_id = 1) const uint SHAPED_LIGHTS = 0u;
const bool SHAPED = SHAPED_LIGHTS != 0u;

// Of a light that has none.
LightShape no_shape() {
  LightShape shape;
  shape.more_follow = 0u;
  shape.parts = 1u;
  return shape;
}
