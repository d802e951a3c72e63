// The way by which light of a rectangle reaches the surface, one for each ray that enters.
#ifndef QUADGRAPH_RECTANGLE_LIGHT_GLSL
#define QUADGRAPH_RECTANGLE_LIGHT_GLSL

#include "material/fresnel.glsl"
#include "shared/beam_shared.h"
#include "shared/random.h"

const uint RECTANGLE_PARTS = RECTANGLE_SIDE * RECTANGLE_SIDE;

// What a place on the rectangle lets into the surface, but for a factor that all places share. to: from the surface.
float let_in(BeamRecord beam, vec3 to, vec3 normal, OpticalSurface surface) {
  float square = dot(to, to), across = dot(normal, to);
  float sent = max(-dot(cross(beam.u, beam.v), to), 0.0);
  return sent * max(across, 0.0) / (square * square) *
         surface_transmittance(clamp(across / sqrt(square), 0.0, 1.0), surface);
}

// From a part that is drawn by what it lets in, as if nothing hid it, and there from anywhere. number: of the ray,
// among all of the surface.
vec3 rectangle_incoming(BeamRecord beam, vec3 position, vec3 normal, uint number, OpticalSurface surface) {
  float part[RECTANGLE_PARTS];
  float all = 0.0;
  vec3 corner = beam.travel_or_from - 0.5 * (beam.u + beam.v) - position;
  vec3 u = beam.u / float(RECTANGLE_SIDE), v = beam.v / float(RECTANGLE_SIDE);
  for (uint k = 0u; k < RECTANGLE_PARTS; ++k) {
    vec3 to = corner + (float(k % RECTANGLE_SIDE) + 0.5) * u + (float(k / RECTANGLE_SIDE) + 0.5) * v;
    part[k] = let_in(beam, to, normal, surface);
    all += part[k];
  }
  if (all == 0.0) return normalize(position - beam.travel_or_from);
  float drawn = spread_number(0u, number, 0u) * all, before = 0.0;
  uint k = 0u;
  while (k + 1u < RECTANGLE_PARTS && before + part[k] <= drawn) {
    before += part[k];
    ++k;
  }
  vec2 place = vec2(float(k % RECTANGLE_SIDE) + spread_number(0u, number, 1u),
                    float(k / RECTANGLE_SIDE) + spread_number(0u, number, 2u));
  return -normalize(corner + place.x * u + place.y * v);
}

#endif
