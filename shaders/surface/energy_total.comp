#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// One workgroup; total[i] = sum of sums[i], sums[i + WORKGROUP_SIZE], ...
struct EnergyTotalPush {
  EnergySumsArray sums;
  EnergySumsArray total;
  uint count;
};
layout(push_constant, scalar) uniform Block { EnergyTotalPush push; };

void main() {
  uint lane = gl_LocalInvocationID.x;
  EnergySums total = EnergySums(vec3(0), vec3(0), vec3(0));
  for (uint k = lane; k < push.count; k += WORKGROUP_SIZE) {
    total.entered += push.sums.at[k].entered;
    total.exitance += push.sums.at[k].exitance;
    total.absorbed += push.sums.at[k].absorbed;
  }
  push.total.at[lane] = total;
}
