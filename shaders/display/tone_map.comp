#version 460
#extension GL_GOOGLE_include_directive : require
#include "display/display_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// A picture as engine/render/picture/png_file.cpp's to_srgb8 shows it, stretched to a part of a screen.
struct ToneMapPush {
  Floats layers[PICTURE_LAYERS];  // RGB per pixel
  Floats alpha;                   // per pixel
  Floats surroundings;            // RGB per pixel
  Uints target;                   // per pixel of the screen's part, 8 bits each, the first lowest; written
  ShownWiths with;                // one
  uint picture_width;
  uint picture_height;
  uint width;  // pixels of the screen's part
  uint height;
  uint false_colour;  // 1: the first layer is linear display colour
  uint blue_first;    // order of the channels: 1 blue, green, red; 0 red, green, blue
  uint surrounded;    // 1: surroundings are seen instead of a background
};
layout(push_constant, scalar) uniform Block { ToneMapPush push; };

vec3 srgb_encode(vec3 linear) {
  return mix(1.055 * pow(max(linear, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055, 12.92 * linear,
             lessThanEqual(linear, vec3(0.0031308)));
}

// engine/render/picture/png_file.cpp.
float dither(uint x, uint y) {
  return fract(52.9829189 * fract(0.06711056 * x + 0.00583715 * y));
}

// A pixel of the picture, or a mean of several.
struct Seen {
  vec3 radiance, transmittance, surroundings;
  float alpha;
};

void add(inout Seen sum, uint x, uint y, float weight) {
  if (weight <= 0.0) return;
  uint i = y * push.picture_width + x;
  for (uint c = 0u; c < 3u; ++c) {
    uint value = 3u * i + c;
    sum.radiance[c] +=
        weight * (max(push.layers[0].at[value], 0.0) + push.layers[1].at[value] + push.layers[2].at[value]);
    sum.transmittance[c] += weight * push.layers[3].at[value];
    if (push.surrounded != 0u) sum.surroundings[c] += weight * push.surroundings.at[value];
  }
  sum.alpha += weight * push.alpha.at[i];
}

// Between the centres of four pixels; one of the same size is seen as it is.
Seen seen_at(uint x, uint y) {
  vec2 size = vec2(push.picture_width, push.picture_height);
  vec2 at = clamp((vec2(x, y) + 0.5) * (size / vec2(push.width, push.height)) - 0.5, vec2(0), size - 1.0);
  uvec2 low = uvec2(at), high = min(low + 1u, uvec2(size) - 1u);
  vec2 share = at - vec2(low);
  Seen sum = Seen(vec3(0), vec3(0), vec3(0), 0.0);
  add(sum, low.x, low.y, (1.0 - share.x) * (1.0 - share.y));
  add(sum, high.x, low.y, share.x * (1.0 - share.y));
  add(sum, low.x, high.y, (1.0 - share.x) * share.y);
  add(sum, high.x, high.y, share.x * share.y);
  return sum;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.width * push.height) return;
  uint x = i % push.width, y = i / push.width;
  Seen seen = seen_at(x, y);
  ShownWith with = push.with.at[0];
  vec3 object = seen.alpha > 0.0 ? seen.alpha * tone_mapped(with.tone, seen.radiance / seen.alpha) : vec3(0);
  if (push.false_colour != 0u) object = seen.radiance;
  vec3 background = mix(with.background_top, with.background_bottom, (y + 0.5) / push.height);
  if (push.surrounded != 0u) background = tone_mapped(with.tone, seen.surroundings);
  vec3 shown = clamp(object + (1.0 - seen.alpha + seen.transmittance) * background, vec3(0), vec3(1));
  uvec3 code = uvec3(min(floor(255.0 * srgb_encode(shown) + dither(x, y)), vec3(255)));
  if (push.blue_first != 0u) code = code.zyx;
  push.target.at[i] = code.x | code.y << 8 | code.z << 16 | 0xff000000u;
}
