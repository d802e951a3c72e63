#ifndef QUADGRAPH_FACE_AZIMUTH_GLSL
#define QUADGRAPH_FACE_AZIMUTH_GLSL

#include "shared/beam_shared.h"

// Azimuths about the normal of a face in its own frame, so that they move with the body: that of BEAM_MEAN, and for the
// rays of the exchange turned on by the radical inverse of `ray` in base 2.
float face_azimuth(uint face, uint ray) {
  uint turn = bitfieldReverse(ray) + face * GOLDEN_TURN;
  return 6.2831853 * (float(turn >> 8u) * exp2(-24.0));
}

#endif
