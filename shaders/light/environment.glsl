// Light from all around by direction.
#ifndef QUADGRAPH_ENVIRONMENT_GLSL
#define QUADGRAPH_ENVIRONMENT_GLSL

#include "light/render_shared.h"

vec3 environment_at(LightShape shape, uint picture, vec3 direction) {
  return environment_in(shape.texels, mat3(shape.right, shape.up, shape.axis), picture, direction);
}

#endif
