// What of a light enters a surface at a point. The shader that includes it defines first
//   ENTERED  what has views, e.g. push
#ifndef QUADGRAPH_ENTERING_GLSL
#define QUADGRAPH_ENTERING_GLSL

#include "light/lights.glsl"
#include "material/fresnel.glsl"
#include "source/leaning.glsl"

#ifndef ENTERED
#error "entering.glsl: ENTERED is not defined"
#endif

// A light as a surface is lit by it: of a projector one channel at a time.
struct Lamp {
  LightRecord light;
  LightShape shape;
  uint channel;
  float width;  // of a sample of the surface, mm
  OpticalSurface surface;
  Leaning leaning;
};

// How many channels of a light are followed, the first of which does for all that are not.
uint channels_of(LightRecord light) {
  return SHAPED && light.kind == LIGHT_PROJECTOR ? 3u : 1u;
}

// What of a light in one place would enter at one point if nothing hid it, over its power: cos * E * F_t(cos),
// by the facets.
float share_from(Lamp lamp, vec3 position, vec3 normal) {
  Incident incident = incident_light(lamp.light, lamp.shape, position);
  float cos_i = min(dot(normal, incident.direction), 1.0);
  if (cos_i <= 0.0 || incident.share <= 0.0) return 0.0;
  if (SHAPED && lamp.light.kind == LIGHT_PROJECTOR) {
    float width = lamp.width / distance(lamp.light.towards_or_at, position);
    incident.share *= projected(lamp.shape, -incident.direction, width)[lamp.channel];
  }
  return let_in_by_facets(lamp.leaning, incident.direction, cos_i, lamp.surface) * incident.share;
}

// Share from a patch, the mean over its parts.
float share_from_parts(Lamp lamp, vec3 position, vec3 normal) {
  vec3 middle = lamp.light.towards_or_at;
  uint n = lamp.shape.parts;
  float sum = 0.0;
  for (uint k = 0u; k < n * n; ++k) {
    vec2 place = (vec2(k % n, k / n) + 0.5) / float(n) - 0.5;
    lamp.light.towards_or_at = middle + place.x * lamp.shape.right + place.y * lamp.shape.up;
    sum += share_from(lamp, position, normal);
  }
  return sum / float(n * n);
}

// q of one light with a direction at one point, over its power.
float share_at(Lamp lamp, vec3 position, vec3 normal) {
  bool parts = SHAPED && lamp.shape.parts > 1u;
  float share = parts ? share_from_parts(lamp, position, normal) : share_from(lamp, position, normal);
  return share > 0.0 ? share * light_visibility(lamp.light, ENTERED.views, position, normal, 0) : 0.0;
}

#endif
