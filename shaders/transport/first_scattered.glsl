// Light that scatters for the first time, of transport_walk.comp.
#ifndef QUADGRAPH_FIRST_SCATTERED_GLSL
#define QUADGRAPH_FIRST_SCATTERED_GLSL

#include "source/fixed_point.glsl"

// mm^3
float volume_of(Vec3s vertices, uvec4 corners) {
  vec3 p = vertices.at[corners.x];
  vec3 e1 = vertices.at[corners.y] - p, e2 = vertices.at[corners.z] - p;
  return abs(dot(e1, cross(e2, vertices.at[corners.w] - p))) / 6.0;
}

// Power that a tet scatters so, W, scaled.
vec3 first_of(Uints deposit, uint tet) {
  vec3 sum = vec3(0);
  for (uint k = 0u; k < 4u; ++k) sum += power_at(deposit, 4u * tet + k);
  return sum;
}

// 20 over a volume, for first_at; 0 where there is none.
float per_volume_of(float volume) {
  return volume > 0.0 ? 20.0 / volume : 0.0;
}

// At a corner, W/mm^3: of the linear function in the tet that has the integrals against its basis functions that the walk
// found. sum: first_of; per_volume: per_volume_of.
vec3 first_at(Uints deposit, uint tet, uint corner, vec3 sum, float per_volume) {
  return per_volume * (power_at(deposit, 4u * tet + corner) - 0.2 * sum);
}

#endif
