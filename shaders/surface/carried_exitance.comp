#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"
#include "shared/stride.glsl"

// What leaves the faces, times what a correction before made of it there: of faces whose light is another now, and of
// all faces where less than half of the light is that of before, less of that.
struct CarriedExitancePush {
  Vec3s exitance;  // W/mm^2, of the solve; then times the factor
  Vec3s solved;    // W/mm^2, of the solve before, and what it was corrected to
  Vec3s corrected;
  Vec3s q;         // W/mm^2
  Vec3s q_before;  // W/mm^2
  Vec3s overlap;   // of light_change.comp
  uint count;
  float same;  // share of the material that is as it was before
};
layout(push_constant, scalar) uniform Block { CarriedExitancePush push; };

void main() {
  vec3 sums = push.overlap.at[0];
  float same = push.same * min(CARRIED_GAIN * sums.x / max(sums.y, 1e-30), 1.0);
  float little = CARRIED_LITTLE * sums.y / sums.z + 1e-30;
  EACH(f, push.count) {
    vec3 solved = push.solved.at[f], corrected = push.corrected.at[f];
    vec3 now = push.q.at[f], before = push.q_before.at[f];
    float light = now.x + now.y + now.z + little, light_before = before.x + before.y + before.z + little;
    float share = same * sqrt(min(light, light_before) / max(light, light_before));
    vec3 factor = mix(vec3(1), corrected / solved, greaterThan(solved, vec3(0)));
    factor = clamp(factor, vec3(1.0 / CARRIED_MOST), vec3(CARRIED_MOST));
    push.exitance.at[f] *= 1.0 + share * (factor - 1.0);
  }
}
