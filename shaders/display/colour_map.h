// Colours for values, the same on the GPU and in the legend.
#ifndef QUADGRAPH_COLOUR_MAP_H
#define QUADGRAPH_COLOUR_MAP_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::clamp;
using glm::mix;
using glm::pow;
#endif

// sRGB in [0, 1] of t in [0, 1]: viridis (N. Smith, S. van der Walt), the polynomial of M. Zucker.
QG_INLINE vec3 viridis(float t) {
  const vec3 c0 = vec3(0.2777273f, 0.0054073f, 0.3340998f), c1 = vec3(0.1050930f, 1.4046135f, 1.3845902f),
             c2 = vec3(-0.3308618f, 0.2148476f, 0.0950952f), c3 = vec3(-4.6342305f, -5.7991010f, -19.3324410f),
             c4 = vec3(6.2282699f, 14.1799334f, 56.6905526f), c5 = vec3(4.7763850f, -13.7451454f, -65.3530326f),
             c6 = vec3(-5.4354559f, 4.6458526f, 26.3124352f);
  return clamp(c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6))))), vec3(0.0f), vec3(1.0f));
}

// From blue over a light grey at one half to red.
QG_INLINE vec3 blue_to_red(float t) {
  const vec3 blue = vec3(0.13f, 0.33f, 0.72f), grey = vec3(0.93f, 0.93f, 0.91f), red = vec3(0.74f, 0.13f, 0.12f);
  return t < 0.5f ? mix(blue, grey, 2.0f * t) : mix(grey, red, 2.0f * t - 1.0f);
}

// Linear colour of t in [0, 1], or of what is outside as of the end that it is beyond.
QG_INLINE vec3 mapped_colour(float t, uint diverging) {
  const float inside = clamp(t, 0.0f, 1.0f);
  const vec3 encoded = diverging != 0u ? blue_to_red(inside) : viridis(inside);
  return pow(encoded, vec3(2.2f));
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
