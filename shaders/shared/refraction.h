// What the smooth surfaces of bodies do to light, and which outside face is of which body; shared with C++, see
// shared.h.
#ifndef QUADGRAPH_REFRACTION_H
#define QUADGRAPH_REFRACTION_H

#include "shared/optical_surface.h"
#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// What a rough surface reflects is known at the squares of even steps of GGX alpha, and of the cosine of the view.
const uint REFLECTANCE_STEPS = 12u;
const uint REFLECTANCE_ROW = REFLECTANCE_STEPS + 1u;
// By GGX alpha, then by cosine; and behind these of the coat's upper side alone, by cosine.
const uint REFLECTANCE_VALUES = (REFLECTANCE_ROW + 1u) * REFLECTANCE_ROW;

// Of a body by its surface.
struct Refraction {
  OpticalSurface surface;
  float transmitted;           // share of uniform illumination from outside that enters
  float kept;                  // share of diffuse light inside that the surface reflects back
  float radiance_norm;         // integral of F_t cos over the hemisphere, sr
  uint entering;               // picture of environments that enters (ENVIRONMENT_ENTERING)
  QG_REF(Floats) reflectance;  // of rough surfaces, REFLECTANCE_VALUES
};

// Kinds of the outside faces of a level: the address of a Refraction for each body in two words, low and high, the
// count of the faces; then for each of these whether light passes it (engine/file/graph.h), and from bit FACE_BODY on
// the number of its body; and the address, or 0, of how facets of the faces lean (shaders/source/leaning.glsl).
const uint FACE_HEAD = 3u;
const uint FACE_OPEN = 0u;
const uint FACE_REFLECTING = 1u;
const uint FACE_BODY = 1u;

#ifndef __cplusplus
QG_ARRAY(Refractions, Refraction);

uint faces_in(Uints kinds) {
  return kinds.at[2];
}

bool is_open(Uints kinds, uint face) {
  return (kinds.at[FACE_HEAD + face] & FACE_REFLECTING) == FACE_OPEN;
}

// The number of the body behind a face.
uint body_behind(Uints kinds, uint face) {
  return kinds.at[FACE_HEAD + face] >> FACE_BODY;
}

Refraction refraction_behind(Uints kinds, uint face) {
  return Refractions(uvec2(kinds.at[0], kinds.at[1])).at[body_behind(kinds, face)];
}

OpticalSurface surface_of(Uints kinds, uint face) {
  return Refractions(uvec2(kinds.at[0], kinds.at[1])).at[body_behind(kinds, face)].surface;
}

float eta_behind(Uints kinds, uint face) {
  return Refractions(uvec2(kinds.at[0], kinds.at[1])).at[body_behind(kinds, face)].surface.eta;
}

// Share of even light from outside that a surface of GGX roughness `alpha` reflects towards a view at that cosine.
float rough_reflectance(Refraction body, float cosine, float alpha) {
  vec2 place = sqrt(clamp(vec2(cosine, alpha), 0.0, 1.0)) * float(REFLECTANCE_STEPS);
  uvec2 cell = min(uvec2(place), uvec2(REFLECTANCE_STEPS - 1u));
  vec2 share = place - vec2(cell);
  uint at = cell.y * REFLECTANCE_ROW + cell.x;
  float less = mix(body.reflectance.at[at], body.reflectance.at[at + 1u], share.x);
  at += REFLECTANCE_ROW;
  float more = mix(body.reflectance.at[at], body.reflectance.at[at + 1u], share.x);
  return mix(less, more, share.y);
}

// Of that the share that the upper side of the coat reflects.
float coat_reflectance(Refraction body, float cosine) {
  if (body.surface.coat == 0.0) return 0.0;
  float place = sqrt(clamp(cosine, 0.0, 1.0)) * float(REFLECTANCE_STEPS);
  uint cell = min(uint(place), REFLECTANCE_STEPS - 1u), at = REFLECTANCE_ROW * REFLECTANCE_ROW + cell;
  return mix(body.reflectance.at[at], body.reflectance.at[at + 1u], place - float(cell));
}
#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
