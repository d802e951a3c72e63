// Light from all around by direction.
#ifndef QUADGRAPH_ENVIRONMENT_GLSL
#define QUADGRAPH_ENVIRONMENT_GLSL

#include "light/shaped.glsl"

// Texel of a picture of an environment.
vec3 environment_texel(Vec3s texels, uint picture, int x, int y) {
  uint column = uint(x + int(ENVIRONMENT_COLUMNS)) % ENVIRONMENT_COLUMNS;
  return texels.at[(picture * ENVIRONMENT_ROWS + uint(y)) * ENVIRONMENT_COLUMNS + column];
}

// A picture of an environment (ENVIRONMENT_*) in a unit direction.
vec3 environment_at(LightShape shape, uint picture, vec3 direction) {
  const float pi = 3.14159265;
  vec3 d = vec3(dot(shape.right, direction), dot(shape.up, direction), dot(shape.axis, direction));
  float longitude = abs(d.x) + abs(d.z) > 0.0 ? atan(d.x, d.z) : 0.0;
  float x = (0.5 + longitude / (2.0 * pi)) * float(ENVIRONMENT_COLUMNS) - 0.5;
  float y = clamp(acos(clamp(d.y, -1.0, 1.0)) / pi * float(ENVIRONMENT_ROWS) - 0.5, 0.0, float(ENVIRONMENT_ROWS - 1u));
  int left = int(floor(x)), top = int(y), bottom = min(top + 1, int(ENVIRONMENT_ROWS) - 1);
  vec2 f = vec2(x, y) - vec2(left, top);
  vec3 upper = mix(environment_texel(shape.texels, picture, left, top),
                   environment_texel(shape.texels, picture, left + 1, top), f.x);
  vec3 lower = mix(environment_texel(shape.texels, picture, left, bottom),
                   environment_texel(shape.texels, picture, left + 1, bottom), f.x);
  return mix(upper, lower, f.y);
}

#endif
