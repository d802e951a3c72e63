// Scattering that goes forwards, for sweeps: delta-Eddington [Joseph 1976]. A share of the light that scatters counts
// as not having scattered; what is left does so by 1 + 3 c cos(angle). Both are chosen so that the first two moments of
// the phase function of Henyey and Greenstein [Henyey 1941] with mean cosine g are kept. By the same code on the device
// and the host.
#ifndef QUADGRAPH_FORWARD_SCATTERING_H
#define QUADGRAPH_FORWARD_SCATTERING_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::max;
using glm::min;
using glm::sqrt;
#endif

// The share, by channel: backwards there is no such peak.
QG_INLINE vec3 forward_peak(vec3 g) {
  vec3 forwards = max(g, vec3(0.0f));
  return forwards * forwards;
}

// What is left of the scattering coefficient, over the reduced one.
QG_INLINE vec3 beside_peak(vec3 g) {
  return (vec3(1.0f) - forward_peak(g)) / (vec3(1.0f) - g);
}

// Its mean cosine c.
QG_INLINE vec3 cosine_beside_peak(vec3 g) {
  return (g - forward_peak(g)) / (vec3(1.0f) - forward_peak(g));
}

// How light scatters beside the peak, for light that does so for the first time, whose direction is known.
struct BesidePeak {
  vec3 g;
  vec3 most;   // of the phase function, 1 where light scatters evenly: there it is cut off, so that its mean is 1
  vec3 mean;   // cosine of what that leaves
  vec3 share;  // of what this is more than linear that counts
};

// That phase function, cut off.
QG_INLINE vec3 cut_off_phase(BesidePeak beside, vec3 cosine) {
  vec3 g = beside.g, s = vec3(1.0f) + g * g - 2.0f * g * cosine;
  return min((vec3(1.0f) - g * g) / (s * sqrt(s) * (vec3(1.0f) - forward_peak(g))), beside.most);
}

// What it is more than 1 + 3 c cos(angle), tilted until the mean cosine is the same, so that it adds neither light nor
// flux.
QG_INLINE vec3 beyond_linear(BesidePeak beside, vec3 cosine) {
  return beside.share * (cut_off_phase(beside, cosine) - 3.0f * beside.mean * cosine - vec3(1.0f));
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
