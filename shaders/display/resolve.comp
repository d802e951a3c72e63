#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
#include "display/pixel.glsl"

vec4 mean_of(Vec4s samples, Pixel pixel) {
  vec4 sum = vec4(0);
  for (uint k = 0u; k < 4u; ++k) sum += load_vec4(samples, sample_of(pixel, k));
  return 0.25 * sum;
}

void main() {
  Pixel pixel;
  if (!find_pixel(pixel)) return;
  vec4 scattered = mean_of(push.samples[0], pixel);
  vec3 layers[PICTURE_LAYERS] = vec3[](scattered.rgb, mean_of(push.samples[1], pixel).rgb,
                                       mean_of(push.samples[2], pixel).rgb, vec3(0));
  write_pixel(pixel, layers, scattered.a);
}
