#ifndef QUADGRAPH_BEAM_LIGHT_GLSL
#define QUADGRAPH_BEAM_LIGHT_GLSL

#include "shared/beam_shared.h"

// What a beam brings to a quarter of a face, W/mm^2. Each beam has its part of a level's
// beam_q, with its floats per face.
vec3 beam_light(Beam beam, Floats beam_q, uint face_count, uint face, uint quarter) {
  uint at = beam.offset * face_count + beam.floats * face;
  if (beam.floats == BEAM_RGB) {
    return vec3(beam_q.at[at], beam_q.at[at + 1u], beam_q.at[at + 2u]);
  }
  if (beam.floats == BEAM_RGB_QUARTERS) {
    at += 3u * quarter;
    return vec3(beam_q.at[at], beam_q.at[at + 1u], beam_q.at[at + 2u]) * beam.colour;
  }
  return beam_q.at[at + (beam.floats == BEAM_QUARTERS ? quarter : 0u)] * beam.colour;
}

#endif
