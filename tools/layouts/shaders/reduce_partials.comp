#version 460
// One workgroup adds up the partial sums that `count` workgroups left.
#define REDUCTION REDUCTION_DISPATCH
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "reduction.glsl"

void main() {
  vec3 mine = vec3(0);
  for (uint k = gl_LocalInvocationID.x; k < push.count; k += WORKGROUP_SIZE) mine += push.reduction.partials[k];
  vec3 total = sum_workgroup(mine);
  if (gl_LocalInvocationID.x == 0u) Vec3s(push.d).at[0] = total;
}
