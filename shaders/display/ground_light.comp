#version 460
#extension GL_GOOGLE_include_directive : require
#include "display/ground_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Irradiance of the ground by what leaves the body, and the share of its sky that the body takes, at the middle of
// every texel. Patches face it or turn away as a whole, and hide none of each other; where they take more than the
// whole sky together, each counts as that much less.
struct GroundLightPush {
  GroundPatches patches;
  Vec4s light;  // GROUND_LIGHT_SIZE^2: RGB, W/mm^2, and the share; written
  vec3 middle;       // mm, of the map
  float half_width;  // mm, of the map
  uint z_up;         // 1: the ground lies across z; 0: across y
  uint patch_count;
};
layout(push_constant, scalar) uniform Block { GroundLightPush push; };

const float PI = 3.14159265;
const float WIDER = 3.0;  // times as large as a patch a disc is

vec3 middle_of(uint texel) {
  vec2 at = (vec2(texel % GROUND_LIGHT_SIZE, texel / GROUND_LIGHT_SIZE) + 0.5) / float(GROUND_LIGHT_SIZE);
  vec2 beside = push.half_width * (2.0 * at - 1.0);
  return push.middle + (push.z_up != 0u ? vec3(beside, 0.0) : vec3(beside.x, 0.0, beside.y));
}

// RGB of what a patch sends along a vector, and its own area along it.
vec4 seen_along(GroundPatch part, vec3 along) {
  return vec4(dot(part.red, along), dot(part.green, along), dot(part.blue, along), dot(part.facing, along));
}

// Share of the sky that a disc takes which lies parallel to the ground so far above it, its middle aside by the root of
// `aside2`, mm^2; radius2: of it.
float disc_factor(float aside2, float above, float radius2) {
  float beyond = aside2 + above * above - radius2, wide = beyond + 2.0 * radius2;
  float root = sqrt(max(wide * wide - 4.0 * radius2 * aside2, 1e-30));
  return beyond > 0.0 ? 2.0 * radius2 * above * above / (root * (root + beyond)) : 0.5 * (1.0 - beyond / root);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= GROUND_LIGHT_SIZE * GROUND_LIGHT_SIZE) return;
  vec3 point = middle_of(i);
  vec3 down = push.z_up != 0u ? vec3(0.0, 0.0, -1.0) : vec3(0.0, -1.0, 0.0);
  vec4 sum = vec4(0);
  for (uint p = 0u; p < push.patch_count; ++p) {
    GroundPatch part = push.patches.at[p];
    vec3 from = point - part.place;
    float above = dot(from, down);
    if (above <= 0.0) continue;
    // What of it looks down is a disc, wider than it and as much weaker, so that discs leave no gaps; the rest a point:
    // the inverse square law with both cosines, softened by half the area (cf. Wallace 1989).
    vec3 aside = from - above * down;
    float soft2 = dot(from, from) + 0.5 / PI * part.area, point_share = above / (PI * soft2 * soft2);
    float facing = max(dot(part.facing, down), 1e-20);
    float disc_share = disc_factor(dot(aside, aside), above, WIDER * facing / PI) / (WIDER * facing);
    sum += max(disc_share * seen_along(part, down) + point_share * seen_along(part, aside), vec4(0));
  }
  push.light.at[i] = sum / max(sum.w, 1.0);
}
