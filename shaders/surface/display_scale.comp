#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

layout(push_constant, scalar) uniform Block { DisplayScalePush push; };

void main() {
  vec3 solved = vec3(0), shown = vec3(0);  // integrals over the face, in units of the scale
  EACH(f, push.count) {
    if (load_uint(push.face_kinds, f) != FACE_OPEN) continue;
    uvec3 corners = load_uvec3(push.faces, f);
    vec3 p = load_vec3(push.vertices, corners.x);
    float area = 0.5 * length(cross(load_vec3(push.vertices, corners.y) - p, load_vec3(push.vertices, corners.z) - p));
    vec3 weight = area * load_scale(push.scale).inverse;
    solved += weight * load_vec3(push.exitance, f);
    for (int k = 0; k < 3; ++k) shown += weight / 3.0 * load_vec3(push.vertex_exitance, corners[k]);
  }
  vec3 total_solved, total_shown;
  if (!reduce_dispatch_pair(push.reduction, solved, shown, total_solved, total_shown)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  push.factor.at[0] = mix(vec3(1), total_solved / total_shown, greaterThan(total_shown, vec3(0)));
}
