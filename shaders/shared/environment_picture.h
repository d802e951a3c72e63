// Pictures of what is all around, by longitude and latitude; shared with C++, see shared.h.
#ifndef QUADGRAPH_ENVIRONMENT_PICTURE_H
#define QUADGRAPH_ENVIRONMENT_PICTURE_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Pictures of an environment, one after the other in its texels (environment.h).
const uint ENVIRONMENT_COLUMNS = 256u;
const uint ENVIRONMENT_ROWS = 128u;
const uint ENVIRONMENT_RAYS = 0u;              // radiance as the rays see it that ask what hides it
const uint ENVIRONMENT_REFLECTED = 1u;         // radiance as a rough surface reflects it, by the mirrored view
const uint ENVIRONMENT_REFLECTED_PLACED = 2u;  // the same where the image of a roughness is white
const uint ENVIRONMENT_COATED = 3u;            // the same as the upper side of a coat reflects it
const uint ENVIRONMENT_ENTERING = 4u;  // from here on one for each surface: irradiance that enters, by the normal

#ifndef __cplusplus
// Texel of a picture of an environment.
vec3 environment_texel(Vec3s texels, uint picture, int x, int y) {
  uint column = uint(x + int(ENVIRONMENT_COLUMNS)) % ENVIRONMENT_COLUMNS;
  return texels.at[(picture * ENVIRONMENT_ROWS + uint(y)) * ENVIRONMENT_COLUMNS + column];
}

// A picture of an environment (ENVIRONMENT_*) in a unit direction. frame: right, up and ahead of it, as columns.
vec3 environment_in(Vec3s texels, mat3 frame, uint picture, vec3 direction) {
  const float pi = 3.14159265;
  vec3 d = vec3(dot(frame[0], direction), dot(frame[1], direction), dot(frame[2], direction));
  float longitude = abs(d.x) + abs(d.z) > 0.0 ? atan(d.x, d.z) : 0.0;
  float x = (0.5 + longitude / (2.0 * pi)) * float(ENVIRONMENT_COLUMNS) - 0.5;
  float y = clamp(acos(clamp(d.y, -1.0, 1.0)) / pi * float(ENVIRONMENT_ROWS) - 0.5, 0.0, float(ENVIRONMENT_ROWS - 1u));
  int left = int(floor(x)), top = int(y), bottom = min(top + 1, int(ENVIRONMENT_ROWS) - 1);
  vec2 f = vec2(x, y) - vec2(left, top);
  vec3 upper =
      mix(environment_texel(texels, picture, left, top), environment_texel(texels, picture, left + 1, top), f.x);
  vec3 lower =
      mix(environment_texel(texels, picture, left, bottom), environment_texel(texels, picture, left + 1, bottom), f.x);
  return mix(upper, lower, f.y);
}
#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
