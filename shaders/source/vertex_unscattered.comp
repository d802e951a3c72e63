#version 460
#extension GL_GOOGLE_include_directive : require
#include "source/walk_shared.h"
#include "source/fixed_point.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { VertexUnscatteredPush push; };

// Power over area of the faces around: interpolated over the faces this carries the same power.
void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  float area = 0.0;
  vec3 power = vec3(0);
  for (uint k = load_uint(push.face_offset, v); k < load_uint(push.face_offset, v + 1u); ++k) {
    uint face = load_uint(push.face_incidence, k);
    uvec3 corners = load_uvec3(push.faces, face);
    vec3 p = load_vec3(push.vertices, corners.x);
    area += 0.5 * length(cross(load_vec3(push.vertices, corners.y) - p, load_vec3(push.vertices, corners.z) - p));
    power += power_at(push.unscattered, face);
  }
  push.vertex_unscattered.at[v] = area > 0.0 ? power / area * load_scale(push.scale).scale : vec3(0);
  push.exitance.at[v] = load_vec3(push.factor, 0u) * load_vec3(push.exitance, v);
}
