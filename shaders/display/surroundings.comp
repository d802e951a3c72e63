#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/image_levels.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Radiance of one environment along the ray of every pixel. Rays are in the frame of its picture:
// right, up, ahead.
struct SurroundingsPush {
  Vec3s texels;         // by longitude and latitude, its middle ahead
  Floats surroundings;  // RGB per pixel, W/(mm^2 sr); written
  ImageLevels image;
  vec3 corner;  // ray to the upper left corner of the picture, 1 along the view
  vec3 right;   // from its left to its right
  vec3 down;    // from its top to its bottom
  vec3 power;   // W/(mm^2 sr) of a texel of 1
  uint width;   // pixels
  uint height;
  uint first;  // 1: written, 0: added
};
layout(push_constant, scalar) uniform Block { SurroundingsPush push; };

const float PI = 3.14159265;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.width * push.height) return;
  vec2 at = (vec2(i % push.width, i / push.width) + 0.5) / vec2(push.width, push.height);
  vec3 ray = push.corner + at.x * push.right + at.y * push.down;
  float pixel = length(push.right) / (float(push.width) * length(ray));  // radians, about
  vec3 d = normalize(ray);
  float longitude = abs(d.x) + abs(d.z) > 0.0 ? atan(d.x, d.z) : 0.0;
  vec2 place = vec2(0.5 + longitude / (2.0 * PI), acos(clamp(d.y, -1.0, 1.0)) / PI);
  vec3 radiance = push.power * load_image(push.texels, image_tap(push.image, place, pixel * float(push.image.rows) / PI));
  for (uint c = 0u; c < 3u; ++c) {
    float before = push.first == 1u ? 0.0 : push.surroundings.at[3u * i + c];
    push.surroundings.at[3u * i + c] = before + radiance[c];
  }
}
