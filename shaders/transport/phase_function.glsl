// Directions into which light scatters.
#ifndef QUADGRAPH_PHASE_FUNCTION_GLSL
#define QUADGRAPH_PHASE_FUNCTION_GLSL

#include "shared/random.glsl"

const float ALL_AROUND = 6.2831853;

// A direction by the angle from an axis and one about it.
vec3 direction_about(vec3 axis, float cosine, float azimuth) {
  vec3 aside = normalize(abs(axis.z) < 0.9 ? vec3(axis.y, -axis.x, 0.0) : vec3(0.0, axis.z, -axis.y));
  vec3 across = cos(azimuth) * aside + sin(azimuth) * cross(axis, aside);
  return normalize(cosine * axis + sqrt(max(1.0 - cosine * cosine, 0.0)) * across);
}

// A direction after light that travels along one has scattered; g: mean cosine of the angle [Henyey 1941], whose
// inverted distribution is written without a difference that a small g would lose.
vec3 scattered_from(vec3 direction, float g, inout uint state) {
  float z = 2.0 * uniform_number(state) - 1.0, azimuth = ALL_AROUND * uniform_number(state);
  if (g == 0.0) return vec3(sqrt(1.0 - z * z) * vec2(cos(azimuth), sin(azimuth)), z);
  float thinned = 1.0 + g * z;
  float cosine = z + 0.5 * g * (z * z + 3.0) + g * g * z - 0.5 * g * g * g * (1.0 - z * z);
  return direction_about(direction, clamp(cosine / (thinned * thinned), -1.0, 1.0), azimuth);
}

#endif
