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

// 1 where the light reaches `depth` (mm from the light) at this texel, else 0. Beyond the map there is no occluder.
float texel_lit(ShadowView view, bool perspective, ivec2 texel, float depth) {
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(view.size)))) return 1.0;
  float z = view.depth.at[texel.y * int(view.size) + texel.x];
  float stored = perspective ? view.near * view.far / (view.far - z * (view.far - view.near))
                             : view.near + z * (view.far - view.near);
  return stored < depth ? 0.0 : 1.0;
}

// Percentage-closer filtering over (2 radius + 2)^2 texels, weighted so that it moves smoothly with the position.
float filtered(ShadowView view, bool perspective, vec2 texel, float depth, int radius) {
  vec2 corner = floor(texel - 0.5);
  vec2 f = texel - 0.5 - corner;
  float sum = 0.0;
  for (int y = -radius; y <= radius + 1; ++y) {
    float weight_y = y == -radius ? 1.0 - f.y : (y == radius + 1 ? f.y : 1.0);
    for (int x = -radius; x <= radius + 1; ++x) {
      float weight_x = x == -radius ? 1.0 - f.x : (x == radius + 1 ? f.x : 1.0);
      sum += weight_x * weight_y * texel_lit(view, perspective, ivec2(corner) + ivec2(x, y), depth);
    }
  }
  float width = float(2 * radius + 1);
  return sum / (width * width);
}

// Share of the light that reaches `position` (mm) on a surface of unit normal `normal`.
float light_visibility(LightRecord light, ShadowViews views, vec3 position, vec3 normal, int radius) {
  bool perspective = light.kind != LIGHT_DIRECTIONAL;
  uint index = light.first_view + (light.view_count == 6u ? cube_view(position - light.towards_or_at) : 0u);
  ShadowView view = views.at[index];
  float w = (view.clip_from_world * vec4(position, 1.0)).w;
  float texel_mm = view.texel * (perspective ? max(w, view.near) : 1.0);
  vec4 clip = view.clip_from_world * vec4(position + SHADOW_NORMAL_OFFSET * texel_mm * normal, 1.0);
  vec3 ndc = clip.xyz / clip.w;
  float depth = perspective ? clip.w : view.near + ndc.z * (view.far - view.near);
  vec2 texel = vec2(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * float(view.size);
  return filtered(view, perspective, texel, depth, radius);
}

#endif
