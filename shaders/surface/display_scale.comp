#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// The factor that gives the exitance at vertices, linear over the faces, the power of the faces.
struct DisplayScalePush {
  Floats face_area;
  Uvec3s faces;
  Uints face_kinds;
  Vec3s exitance;
  Vec3s vertex_exitance;
  Scales scale;
  Vec3s factor;
  Reduction reduction;
  uint count;
};
layout(push_constant, scalar) uniform Block { DisplayScalePush push; };

void main() {
  vec3 solved = vec3(0), shown = vec3(0);  // integrals over the face, in units of the scale
  EACH(f, push.count) {
    if (!is_open(push.face_kinds, f)) continue;
    uvec3 corners = push.faces.at[f];
    vec3 weight = push.face_area.at[f] * push.scale.at[0].inverse;
    solved += weight * push.exitance.at[f];
    for (int k = 0; k < 3; ++k) shown += weight / 3.0 * push.vertex_exitance.at[corners[k]];
  }
  vec3 total_solved, total_shown;
  if (!reduce_dispatch_pair(push.reduction, solved, shown, total_solved, total_shown)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  push.factor.at[0] = mix(vec3(1), total_solved / total_shown, greaterThan(total_shown, vec3(0)));
}
