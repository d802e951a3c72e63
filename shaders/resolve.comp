#version 460
#extension GL_GOOGLE_include_directive : require
#include "render_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ResolvePush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.tile_width * push.tile_height) return;
  uint x = i % push.tile_width, y = i / push.tile_width;
  uint s = 2u * y * push.sample_stride + 2u * x;
  uint below = s + push.sample_stride;
  vec4 diffuse = 0.25 * (push.diffuse_samples.at[s] + push.diffuse_samples.at[s + 1u] +
                         push.diffuse_samples.at[below] + push.diffuse_samples.at[below + 1u]);
  vec4 specular = 0.25 * (push.specular_samples.at[s] + push.specular_samples.at[s + 1u] +
                          push.specular_samples.at[below] + push.specular_samples.at[below + 1u]);
  uint pixel = (push.tile_y + y) * push.picture_width + push.tile_x + x;
  for (uint c = 0u; c < 3u; ++c) {
    push.diffuse.at[3u * pixel + c] = diffuse[c];
    push.specular.at[3u * pixel + c] = specular[c];
  }
  push.alpha.at[pixel] = diffuse.a;
}
