// What a light is on the device, and how its light is spread over directions: GLSL and C++ share the constants. A kind
// of light that a user states becomes one record or several of these (engine/render/light/light_set.h).
#ifndef QUADGRAPH_LIGHT_KINDS_H
#define QUADGRAPH_LIGHT_KINDS_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

const uint LIGHT_DIRECTIONAL = 0u;
const uint LIGHT_POINT = 1u;
const uint LIGHT_AMBIENT = 2u;
// Kinds from here on have a LightShape. Passes that know them are pipelines of their own, by a specialization constant
// (lights.glsl), so that scenes without such lights do not run their code.
const uint LIGHT_FIRST_SHAPED = 3u;
const uint LIGHT_SPOT = 3u;
const uint LIGHT_PATCH = 4u;  // of a rectangle
const uint LIGHT_PROJECTOR = 5u;
const uint LIGHT_ENVIRONMENT = 6u;

struct LightRecord {
  uint kind;           // LIGHT_*
  vec3 towards_or_at;  // directional: unit, towards the light; ambient, environment: unused; others: its place, mm
  vec3 power;  // directional, ambient: irradiance, W/mm^2; environment: radiance of what is 1 in its texels, W/(mm^2
               // sr); point: intensity, W/sr; spot: the same on the axis; patch: the same of its whole rectangle;
               // projector: the same where the image is white
  uint first_view;  // into the array of ShadowView
  uint view_count;  // 0 (ambient), 1, or 6 in the order +x -x +y -y +z -z
};

// How the light is spread over directions.
struct LightShape {
  vec3 axis;         // unit, the way the light travels
  float inner;       // spot: cosine of the angle from the axis at which it begins to fade
  float outer;       // spot: cosine at which it ends
  float share;       // patch: of its rectangle
  float width;       // patch: of its longer side, mm
  uint more_follow;  // 1: the next record is part of the same beam
  // Environment: unit vectors, axis to the middle of its picture (environment.h: ahead); its texels are the pictures of
  // render_shared.h. Projector: a direction d is (dot(right, d), dot(up, d)) / dot(axis, d) of the way from the image's
  // middle to its right and upper edge. Its levels of columns x rows texels, RGB, top row first, each half as large as
  // the one before, rounded down.
  vec3 right;  // patch: its sides, mm
  vec3 up;
  QG_REF(Vec3s) texels;
  uint columns;
  uint rows;
  uint levels;
  uint parts;  // patch: along either side, that send out light apart, though hidden as one
};

#ifndef __cplusplus
// Share of the intensity on the axis of a spot light in a direction at that cosine from it.
float spot_share(LightShape shape, float cosine) {
  float s = clamp((cosine - shape.outer) / max(shape.inner - shape.outer, 1e-7), 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

// Share of the intensity on the axis, for a flat image of uniform irradiance: 1 / cosine^3.
float projected_share(float cosine) {
  return cosine > 0.0 ? 1.0 / (cosine * cosine * cosine) : 0.0;
}

float shaped_share(uint kind, LightShape shape, float cosine) {
  if (kind == LIGHT_SPOT) return spot_share(shape, cosine);
  if (kind == LIGHT_PATCH) return shape.share * max(cosine, 0.0);
  return projected_share(cosine);
}
#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
