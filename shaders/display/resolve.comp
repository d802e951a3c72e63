#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ResolvePush push; };
#include "display/pixel.glsl"

vec4 mean_of(Vec4s samples, Pixel pixel) {
  vec4 sum = vec4(0);
  for (uint k = 0u; k < 4u; ++k) sum += samples.at[sample_of(pixel, k)];
  return 0.25 * sum;
}

void main() {
  Pixel pixel;
  if (!find_pixel(pixel)) return;
  vec4 scattered = mean_of(push.samples[0], pixel);
  vec3 layers[PICTURE_LAYERS];
  layers[0] = scattered.xyz;
  layers[1] = mean_of(push.samples[1], pixel).xyz;
  layers[2] = mean_of(push.samples[2], pixel).xyz;
  layers[3] = vec3(0);
  write_pixel(pixel, layers, scattered.w);
}
