// What is known from before, in the present scale. The shader that includes it defines first push constants `push` with
// keep, the share of it that counts, unit, the scale that it has, and scale.
#ifndef QUADGRAPH_KEPT_GLSL
#define QUADGRAPH_KEPT_GLSL

// Without a share nothing need be known.
vec3 kept(vec3 known) {
  return push.keep == 0.0 ? vec3(0) : push.keep * push.unit.at[0] * push.scale.at[0].inverse * known;
}

#endif
