// A ray of light through the tets, and what becomes of its power. The shader that includes it defines first BODY
// (tet_ray.glsl).
#ifndef QUADGRAPH_LIGHT_RAY_GLSL
#define QUADGRAPH_LIGHT_RAY_GLSL

#include "source/tet_ray.glsl"

struct Ray {
  TetPoint at;
  vec3 direction;
  vec3 power;
  vec3 carry;   // of power, that rounding kept back
  float slope;  // length of the way that it stands for, over its own
};

vec3 absorbed;     // by this invocation's rays
vec3 unscattered;  // of them: left through the surface, or still under way at the end

// Share of the loss that is scattered: never above 1, even where division rounds up.
vec3 albedo(Optical optical) {
  return min(optical.sigma_s_prime / max(extinction(optical), vec3(1e-30)), vec3(1));
}

#endif
