// Where rays of light enter a face, and of light from all around the direction that each has of its own.
#ifndef QUADGRAPH_ENTERING_RAYS_GLSL
#define QUADGRAPH_ENTERING_RAYS_GLSL

#include "material/fresnel.glsl"
#include "source/leaning.glsl"
#include "shared/beam_shared.h"
#include "shared/environment_picture.h"
#include "shared/random.glsl"

// Directions that one is drawn from, by what it brings; where a sky is even, it is taken as it comes.
const uint SKY_CANDIDATES = 8u;

// Whether a beam is ambient light or that of an environment.
bool is_sky(Beam beam) {
  return beam.floats == BEAM_FACE || uvec2(beam.picture) != uvec2(0);
}

// W/(mm^2 sr) from a direction.
vec3 sky_radiance(Beam beam, vec3 towards) {
  if (uvec2(beam.picture) == uvec2(0)) return beam.colour / 3.1415927;
  mat3 frame = mat3(beam.way.u, beam.way.v, beam.way.travel_or_from);
  return max(beam.colour * environment_in(beam.picture, frame, ENVIRONMENT_RAYS, towards), vec3(0));
}

// A ray of the sky that enters a face where nothing hides it.
struct SkyRay {
  vec3 towards;  // outside
  vec3 let_in;   // of what comes from there, pi times radiance times transmittance, by the chance that it was drawn
};

// Drawn among candidates by what they bring (resampled importance sampling, Talbot, Cline and Egbert 2005), which are
// spread over the hemisphere by its cosine. number: of the ray, among all of the surface; along: any way in the face;
// leaning: of its facets, by which the light enters.
SkyRay drawn_from_sky(Beam beam, uint number, vec3 normal, Leaning leaning, vec3 along, OpticalSurface surface, inout uint state) {
  vec3 tangent = normalize(along);
  SkyRay drawn = SkyRay(normal, vec3(0));
  vec3 other = cross(normal, tangent);
  float all = 0.0, chosen = 1.0;
  uint candidates = uvec2(beam.picture) == uvec2(0) ? 1u : SKY_CANDIDATES;
  for (uint k = 0u; k < candidates; ++k) {
    uint n = candidates * number + k;
    float square = spread_number(0u, n, 0u), azimuth = 6.2831853 * spread_number(0u, n, 1u);
    vec3 across = cos(azimuth) * tangent + sin(azimuth) * other;
    vec3 towards = sqrt(square) * normal + sqrt(1.0 - square) * across;
    float cosine = sqrt(square), enters = let_in_by_facets(leaning, towards, cosine, surface) / max(cosine, 1e-20);
    vec3 let_in = 3.1415927 * enters * sky_radiance(beam, towards);
    float weight = let_in.x + let_in.y + let_in.z;
    all += weight;
    if (uniform_number(state) * all < weight) {
      drawn = SkyRay(towards, let_in);
      chosen = weight;
    }
  }
  drawn.let_in *= all / (float(candidates) * chosen);
  return drawn;
}

// Barycentric coordinates of a place on a face, anywhere in it. number: of the ray, among all of the surface.
vec3 spread_over_face(uint number) {
  float side = sqrt(spread_number(0u, number, 3u)), along = side * spread_number(0u, number, 4u);
  return vec3(1.0 - side, side - along, along);
}

// The same on a quarter of a face.
vec3 spread_over_quarter(uint number, uint quarter) {
  vec3 l = 0.5 * spread_over_face(number);
  if (quarter + 1u == FACE_QUARTERS) return 0.5 - l;
  l[quarter] += 0.5;
  return l;
}

#endif
