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

vec3 middle_of(uint texel) {
  vec2 at = (vec2(texel % GROUND_LIGHT_SIZE, texel / GROUND_LIGHT_SIZE) + 0.5) / float(GROUND_LIGHT_SIZE);
  vec2 beside = push.half_width * (2.0 * at - 1.0);
  return push.middle + (push.z_up != 0u ? vec3(beside, 0.0) : vec3(beside.x, 0.0, beside.y));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= GROUND_LIGHT_SIZE * GROUND_LIGHT_SIZE) return;
  vec3 point = middle_of(i);
  vec4 sum = vec4(0);
  for (uint p = 0u; p < push.patch_count; ++p) {
    GroundPatch part = push.patches.at[p];
    vec3 from = point - part.place;
    float above = push.z_up != 0u ? -from.z : -from.y;
    if (above <= 0.0) continue;
    float far2 = dot(from, from);
    // The inverse square law with both cosines; softened by half the area, so that what is nearer than a patch is wide
    // does not show where its middle is (cf. the disc of Wallace 1989).
    float share = above / (far2 * (PI * far2 + 0.5 * part.area));
    sum += share * max(vec4(dot(part.red, from), dot(part.green, from), dot(part.blue, from),
                            dot(part.facing, from)), vec4(0));
  }
  push.light.at[i] = sum / max(sum.w, 1.0);
}
