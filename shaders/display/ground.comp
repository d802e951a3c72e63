#version 460
#extension GL_GOOGLE_include_directive : require
#include "display/ground_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Darkens and lights what is seen beside the body, by an eye above the ground. The shadow, and the share of the
// ground's sky that the body takes, count as coverage; what comes from there instead of the sky is the body's light.
struct GroundPush {
  Floats shadow;
  Vec4s light;   // per texel of its map: irradiance, W/mm^2, and the share of the sky that the body takes; or null
  Floats scattered;  // RGB per pixel, W/(mm^2 sr), added to
  Floats alpha;      // per pixel, written
  // On the plane through what the camera looks at, mm.
  vec3 target;           // the middle of the picture, from that of the map
  vec3 corner;           // from there to the upper left corner of the picture
  vec3 right;            // from its left to its right
  vec3 down;             // from its top to its bottom
  vec3 ahead;            // from the eye to its middle, 1 long along the view
  float spread;          // 1/mm: over the distance of the eye; 0 of parallel rays
  float half_width;      // mm, of the map of the shadow
  float light_half_width;  // mm, of that of the light
  uint z_up;             // 1: the ground lies across z; 0: across y
  uint width;            // pixels
  uint height;
};
layout(push_constant, scalar) uniform Block { GroundPush push; };

const float PI = 3.14159265;

float shadow_of(ivec2 texel) {
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(GROUND_SIZE)))) return 0.0;
  return push.shadow.at[texel.y * GROUND_SIZE + texel.x];
}

// Between texels; `place` from -1 to 1 over the map.
float shadow_at(vec2 place) {
  if (any(greaterThan(abs(place), vec2(1.1)))) return 0.0;
  vec2 texel = (0.5 + 0.5 * place) * float(GROUND_SIZE) - 0.5;
  ivec2 low = ivec2(floor(texel));
  vec2 f = texel - floor(texel);
  return mix(mix(shadow_of(low), shadow_of(low + ivec2(1, 0)), f.x),
             mix(shadow_of(low + ivec2(0, 1)), shadow_of(low + ivec2(1, 1)), f.x), f.y);
}

vec4 light_of(ivec2 texel) {
  texel = clamp(texel, ivec2(0), ivec2(GROUND_LIGHT_SIZE) - 1);
  return push.light.at[texel.y * GROUND_LIGHT_SIZE + texel.x];
}

// Between texels; `place` from -1 to 1 over the map, at whose sides there is none.
vec4 light_at(vec2 place) {
  float far = length(place);
  if (uvec2(push.light) == uvec2(0) || far >= 1.0) return vec4(0);
  vec2 texel = (0.5 + 0.5 * place) * float(GROUND_LIGHT_SIZE) - 0.5;
  ivec2 low = ivec2(floor(texel));
  vec2 f = texel - floor(texel);
  vec4 light = mix(mix(light_of(low), light_of(low + ivec2(1, 0)), f.x),
                   mix(light_of(low + ivec2(0, 1)), light_of(low + ivec2(1, 1)), f.x), f.y);
  return (1.0 - smoothstep(GROUND_LIGHT_FADES, 1.0, far)) * light;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.width * push.height || push.alpha.at[i] >= 1.0) return;
  vec2 at = (vec2(i % push.width, i / push.width) + 0.5) / vec2(push.width, push.height);
  vec3 beside = push.corner + at.x * push.right + at.y * push.down;
  vec3 point = push.target + beside, ray = push.ahead + push.spread * beside;
  uint axis = push.z_up != 0u ? 2u : 1u;
  if (ray[axis] >= 0.0) return;
  vec3 hit = point - point[axis] / ray[axis] * ray;
  vec2 place = push.z_up != 0u ? hit.xy : hit.xz;
  vec4 light = light_at(place / push.light_half_width);
  float shadow = max(shadow_at(place / push.half_width), GROUND_STRENGTH * light.w), seen = 1.0 - push.alpha.at[i];
  for (uint c = 0u; c < 3u; ++c) push.scattered.at[3u * i + c] += seen * GROUND_ALBEDO / PI * light[c];
  push.alpha.at[i] += seen * shadow;
}
