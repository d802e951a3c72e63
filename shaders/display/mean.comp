#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The mean of the frames of a picture, number by number, with one more of them.
struct MeanPush {
  Floats frame;
  Floats mean;  // written; read unless this is the first frame
  uint count;
  float share;  // of the new frame; 1 of the first
};
layout(push_constant, scalar) uniform Block { MeanPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  float found = push.frame.at[i];
  // What is the same in all frames keeps its bits: where a pixel is covered by all, alpha is 1.
  push.mean.at[i] = push.share < 1.0 ? push.mean.at[i] + push.share * (found - push.mean.at[i]) : found;
}
