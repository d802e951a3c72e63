// Light that arrives at a point: direction, irradiance facing the light, and visibility from the shadow maps.
#ifndef QUADGRAPH_LIGHTS_GLSL
#define QUADGRAPH_LIGHTS_GLSL

#include "light/shaped.glsl"
#include "shared/image_levels.h"

struct Incident {
  vec3 direction;  // unit, towards the light
  float share;     // irradiance on a plane facing the light, over its power; point: 1/mm^2
};

// The image of a projector in a direction away from it; black beside it. `width` is that of a sample there, mm over the
// distance from the light: texels that are finer are taken together.
vec3 projected(LightShape shape, vec3 away, float width) {
  vec2 place = vec2(dot(shape.right, away), dot(shape.up, away)) / dot(shape.axis, away);
  if (any(greaterThan(abs(place), vec2(1)))) return vec3(0);
  float finest = 2.0 / (float(shape.rows) * length(shape.up));
  ImageLevels image = ImageLevels(0u, shape.columns, shape.rows, shape.levels);
  return load_image(shape.texels, image_tap(image, vec2(0.5 + 0.5 * place.x, 0.5 - 0.5 * place.y), width / finest));
}

Incident incident_light(LightRecord light, LightShape shape, vec3 position) {
  if (light.kind == LIGHT_DIRECTIONAL) return Incident(light.towards_or_at, 1.0);
  vec3 to_light = light.towards_or_at - position;
  float distance_squared = max(dot(to_light, to_light), 1e-12);
  Incident incident = Incident(to_light * inversesqrt(distance_squared), 1.0 / distance_squared);
  if (SHAPED && light.kind >= LIGHT_FIRST_SHAPED) {
    incident.share *= shaped_share(light.kind, shape, -dot(incident.direction, shape.axis));
  }
  return incident;
}

// Index among the six views of the one that `away`, pointing from the light, falls into.
uint cube_view(vec3 away) {
  vec3 size = abs(away);
  uint axis = size.x >= size.y && size.x >= size.z ? 0u : (size.y >= size.z ? 1u : 2u);
  return 2u * axis + (away[axis] < 0.0 ? 1u : 0u);
}

// Where a point lies in a view's map.
struct ShadowPlace {
  vec2 texel;
  float depth;  // as the map has it; what is stored there and is less hides the point
};

// 1 where the light reaches `depth` at this texel, else 0. Beyond the map there is no occluder.
float texel_lit(ShadowView view, ivec2 texel, float depth) {
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(view.size)))) return 1.0;
  return view.depth.at[texel.y * int(view.size) + texel.x] < depth ? 0.0 : 1.0;
}

// Weight of one of the 2 radius + 2 columns or rows around a place that is `f` after the one at -`radius`.
float tap_weight(int tap, float f, int radius) {
  return tap == 0 ? 1.0 - f : (tap == 2 * radius + 1 ? f : 1.0);
}

// Percentage-closer filtering over (2 radius + 2)^2 texels, weighted so that it moves smoothly with the position;
// `radius` 0 or 1.
float filtered(ShadowView view, ShadowPlace place, int radius) {
  vec2 corner = floor(place.texel - 0.5);
  vec2 f = place.texel - 0.5 - corner;
  ivec2 first = ivec2(corner) - radius;
  int taps = 2 * radius + 2, size = int(view.size);
  float sum = 0.0;
  if (min(first.x, first.y) < 0 || max(first.x, first.y) + taps > size) {
    for (int y = 0; y < taps; ++y) {
      for (int x = 0; x < taps; ++x) {
        float weight = tap_weight(x, f.x, radius) * tap_weight(y, f.y, radius);
        sum += weight * texel_lit(view, first + ivec2(x, y), place.depth);
      }
    }
  } else if (radius == 0) {
    int at = first.y * size + first.x;
    vec4 stored = vec4(view.depth.at[at], view.depth.at[at + 1], view.depth.at[at + size], view.depth.at[at + size + 1]);
    vec4 lit = mix(vec4(1), vec4(0), lessThan(stored, vec4(place.depth)));
    sum = mix(mix(lit.x, lit.y, f.x), mix(lit.z, lit.w, f.x), f.y);
  } else {
    vec4 columns = vec4(0);
    for (int y = 0; y < 4; ++y) {
      int at = (first.y + y) * size + first.x;
      vec4 stored = vec4(view.depth.at[at], view.depth.at[at + 1], view.depth.at[at + 2], view.depth.at[at + 3]);
      columns += tap_weight(y, f.y, 1) * mix(vec4(1), vec4(0), lessThan(stored, vec4(place.depth)));
    }
    sum = dot(columns, vec4(1.0 - f.x, 1.0, 1.0, f.x));
  }
  return sum / float((taps - 1) * (taps - 1));
}

#ifdef QG_PROCESSOR
// Asks memory for the texels between places before they are read one after the other.
void fetch_between(ShadowView view, vec2 least, vec2 most) {
  const int line = 16, rows = 32, size = int(view.size);  // texels that memory gives at once; rows at most
  ivec2 low = clamp(ivec2(least) - 1, ivec2(0), ivec2(size - 1));
  ivec2 high = min(min(ivec2(most) + 1, ivec2(size - 1)), low + rows);
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x < high.x + line; x += line) fetch_ahead(view.depth, y * size + min(x, high.x));
  }
}
#endif

// The view of a light's map that a position falls into.
uint shadow_view(LightRecord light, vec3 position) {
  return light.first_view + (light.view_count == 6u ? cube_view(position - light.towards_or_at) : 0u);
}

// Where a view of a shadow map sees a point (mm) of a surface of unit normal `normal`.
ShadowPlace shadow_place(ShadowView view, bool perspective, vec3 position, vec3 normal) {
  float texel_mm = view.texel;
  if (perspective) texel_mm *= max((view.clip_from_world * vec4(position, 1.0)).w, view.near);
  vec4 clip = view.clip_from_world * vec4(position + SHADOW_NORMAL_OFFSET * texel_mm * normal, 1.0);
  vec2 ndc = perspective ? clip.xy / clip.w : clip.xy;
  float depth = perspective ? view.far * (clip.w - view.near) / (clip.w * (view.far - view.near)) : clip.z;
  return ShadowPlace(vec2(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * float(view.size), depth);
}

// Share of the light that reaches `position` (mm) on a surface of unit normal `normal`.
float light_visibility(LightRecord light, ShadowViews views, vec3 position, vec3 normal, int radius) {
  ShadowView view = views.at[shadow_view(light, position)];
  return filtered(view, shadow_place(view, light.kind != LIGHT_DIRECTIONAL, position, normal), radius);
}

#endif
