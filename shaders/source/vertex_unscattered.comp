#version 460
#extension GL_GOOGLE_include_directive : require
#include "source/walk_shared.h"
#include "source/fixed_point.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Multiplies the exitance at surface vertices by a factor, and gives that of unscattered
// light.
struct VertexUnscatteredPush {
  Floats face_area;
  Uints face_offset;
  Uints face_incidence;
  Uints unscattered;
  Scales scale;
  Vec3s factor;  // one
  Vec3s exitance;
  Vec3s vertex_unscattered;  // W/mm^2, written
  uint count;
};
layout(push_constant, scalar) uniform Block { VertexUnscatteredPush push; };

// Power over area of the faces around: interpolated over the faces this carries the same power.
void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  float area = 0.0;
  vec3 power = vec3(0);
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    uint face = push.face_incidence.at[k];
    area += push.face_area.at[face];
    power += power_at(push.unscattered, face);
  }
  push.vertex_unscattered.at[v] = area > 0.0 ? power / area * push.scale.at[0].scale : vec3(0);
  push.exitance.at[v] = push.factor.at[0u] * push.exitance.at[v];
}
