// What leaves the surface at a point, between the middles of cells.
#ifndef QUADGRAPH_PATH_FIELD_GLSL
#define QUADGRAPH_PATH_FIELD_GLSL

#include "path/path_shared.h"

// W/mm^2, of the cells of the surface around.
vec3 path_exitance(PathField field, vec3 position) {
  vec3 place = (position - field.grid.origin) / field.grid.cell - 0.5;
  place = clamp(place, vec3(0), vec3(field.grid.size) - 1.001);
  uvec3 low = uvec3(place);
  vec3 f = place - vec3(low);
  vec4 sum = vec4(0);
  for (uint k = 0u; k < 8u; ++k) {
    uvec3 corner = uvec3(k & 1u, k >> 1u & 1u, k >> 2u);
    vec3 share = mix(1.0 - f, f, vec3(corner));
    sum += share.x * share.y * share.z * field.field.at[cell_number(field.grid, low + corner)];
  }
  return sum.w > 0.0 ? sum.xyz / sum.w : vec3(0);
}

#endif
