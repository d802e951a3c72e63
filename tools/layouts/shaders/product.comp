#version 460
// y = A x; with REDUCTION also the sum of x y.
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "rows.glsl"
#ifdef REDUCTION
#include "reduction.glsl"
#endif

#if ROWS == ROWS_CSR_SUBGROUP
Field subgroup_sum(Field part) {
#if MOMENTS == 1
  return Field(subgroupAdd(part.phi));
#else
  return Field(subgroupAdd(part.phi), subgroupAdd(part.phi2));
#endif
}

void main() {
  uint i = gl_WorkGroupID.x * gl_NumSubgroups + gl_SubgroupID;
  if (i >= push.count) return;
  Row row = row_at(i, load(push.x, i));
  Field result = subgroup_sum(row_times(i, row));
  if (subgroupElect()) store(push.y, i, result);
}
#else
void main() {
  uint slot = gl_GlobalInvocationID.x;
  vec3 energy = vec3(0);
  if (slot < push.count) {
    uint i = row_of(slot);
    Row row = row_at(i, load(push.x, i));
    Field result = row_times(slot, row);
    store(push.y, i, result);
    energy = product(row.own, result);
  }
#ifdef REDUCTION
  vec3 total;
  if (sum_dispatch(push.reduction, energy, total) && gl_LocalInvocationID.x == 0u) Vec3s(push.d).at[0] = total;
#endif
}
#endif
