#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"
#include "shared/reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// One workgroup: which carriers are of the third of the surface that has the least exitance M, the sum of its channels,
// to within an eighth of a stop. None are where all is dark.
struct SurfaceDimmestPush {
  Vec3s m;  // per carrier
  SurfaceShares share;
  uint count;
};
layout(push_constant, scalar) uniform Block { SurfaceDimmestPush push; };

const uint BINS = 512u;
const uint BIN_SHIFT = 19u;  // of the bits of a number, of which it leaves 16 bins for each stop
const float WHOLE = 16777216.0;  // the surface, in units of a bin
const float THIRD = 1.0 / 3.0;

shared uint bins[BINS];
shared float least_area, brightest;
shared uint last;  // bin of the dimmest third

float brightness(uint carrier) {
  vec3 m = push.m.at[carrier];
  return max(m.x + m.y + m.z, 0.0);
}

// Of numbers above 0 the bits grow about as the logarithm. What is too dark for the others is in the first.
uint bin_of(float bright) {
  if (!(bright > 0.0)) return 0u;
  uint below = (floatBitsToUint(brightest) - floatBitsToUint(bright)) >> BIN_SHIFT;
  return below < BINS ? BINS - 1u - below : 0u;
}

void find_extent() {
  float area = 0.0, most = 0.0;
  for (uint i = gl_LocalInvocationID.x; i < push.count; i += WORKGROUP_SIZE) {
    area += push.share.at[i].area.x;
    most = max(most, brightness(i));
  }
  vec3 sum = reduce_workgroup(vec3(area, 0, 0));
  if (gl_LocalInvocationID.x == 0u) {
    least_area = max(sum.x, 1e-30) / WHOLE;
    brightest = 0.0;
  }
  barrier();
  // Of numbers that are not negative the bits order as they do.
  atomicMax(bins[0], floatBitsToUint(most));
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    brightest = uintBitsToFloat(bins[0]);
    bins[0] = 0u;
  }
  barrier();
}

void main() {
  for (uint k = gl_LocalInvocationID.x; k < BINS; k += WORKGROUP_SIZE) bins[k] = 0u;
  barrier();
  find_extent();
  for (uint i = gl_LocalInvocationID.x; i < push.count; i += WORKGROUP_SIZE) {
    uint area = uint(push.share.at[i].area.x / least_area);
    atomicAdd(bins[bin_of(brightness(i))], area);
  }
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    uint below = 0u;
    for (last = 0u; last + 1u < BINS; ++last) {
      below += bins[last];
      if (float(below) >= THIRD * WHOLE) break;
    }
  }
  barrier();
  for (uint i = gl_LocalInvocationID.x; i < push.count; i += WORKGROUP_SIZE) {
    bool dim = brightest > 0.0 && bin_of(brightness(i)) <= last;
    vec3 area = push.share.at[i].area;
    push.share.at[i].area = vec3(area.x, area.y, dim ? area.x : 0.0);
  }
}
