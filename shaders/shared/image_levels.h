// Reading pictures at the fineness of what asks, by the same code on the GPU and in the CPU reference; see shared.h.
#ifndef QUADGRAPH_IMAGE_LEVELS_H
#define QUADGRAPH_IMAGE_LEVELS_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::clamp;
using glm::dot;
using glm::floor;
using glm::max;
using glm::min;
using glm::mix;
#endif

// A picture in an array of RGB texels, from `first` on: levels of columns x rows texels, top row first, each half as
// large as the one before, rounded down, to a single texel.
struct ImageLevels {
  uint first;
  uint columns;
  uint rows;
  uint levels;  // 0: no picture
};

// The four texels around a place, and how far it lies from the first to those on its right and below.
struct ImageTap {
  uint upper_left;
  uint upper_right;
  uint lower_left;
  uint lower_right;
  vec2 share;
};

// A whole number from -1 to `count` as one of those that are repeated.
QG_INLINE uint wrapped(float index, uint count) {
  float size = float(count);
  return uint(index < 0.0f ? index + size : index < size ? index : index - size);
}

// Around `place`, 0 to 1 from the upper left corner, in the level whose texels are about `texels` of the finest a side;
// beyond them the picture ends, or is repeated.
QG_INLINE ImageTap tap_of(ImageLevels image, vec2 place, float texels, bool repeated) {
  uvec2 size = uvec2(image.columns, image.rows);
  uint first = image.first;
  float wanted = 1.41421356f;  // to the nearest power of two
  for (uint k = 1u; k < image.levels && wanted < texels; ++k) {
    first += size.x * size.y;
    size = max(size / 2u, uvec2(1u));
    wanted *= 2.0f;
  }
  vec2 last = vec2(size) - vec2(1.0f);
  vec2 texel = (repeated ? place - floor(place) : place) * vec2(size) - vec2(0.5f);
  if (!repeated) texel = clamp(texel, vec2(0.0f), last);
  vec2 whole = floor(texel);
  uvec2 low = uvec2(wrapped(whole.x, size.x), wrapped(whole.y, size.y));
  uvec2 high = min(low + uvec2(1u), size - uvec2(1u));
  if (repeated) high = uvec2(wrapped(whole.x + 1.0f, size.x), wrapped(whole.y + 1.0f, size.y));
  uint upper = first + low.y * size.x;
  uint lower = first + high.y * size.x;
  ImageTap tap;
  tap.upper_left = upper + low.x;
  tap.upper_right = upper + high.x;
  tap.lower_left = lower + low.x;
  tap.lower_right = lower + high.x;
  tap.share = texel - whole;
  return tap;
}

QG_INLINE ImageTap image_tap(ImageLevels image, vec2 place, float texels) {
  return tap_of(image, place, texels, false);
}

QG_INLINE vec3 mixed(ImageTap tap, vec3 upper_left, vec3 upper_right, vec3 lower_left, vec3 lower_right) {
  return mix(mix(upper_left, upper_right, tap.share.x), mix(lower_left, lower_right, tap.share.x), tap.share.y);
}

QG_INLINE float luminance(vec3 rgb) {
  return dot(rgb, vec3(0.2126f, 0.7152f, 0.0722f));
}

// Where a picture lies in a body: in a box, seen along one of its axes; mm, in the shape at rest.
struct ImageBox {
  vec3 centre;
  vec3 right;      // unit, to the picture's right edge
  vec3 up;         // unit, to its top
  vec3 half_size;  // mm, to the right, up, and along the third axis, right x up
};

// mm from the centre along the axes of the box.
QG_INLINE vec3 in_box(ImageBox box, vec3 p) {
  vec3 d = p - box.centre;
  return vec3(dot(box.right, d), dot(box.up, d), dot(cross(box.right, box.up), d));
}

// Place in the picture of a point in the box, as image_tap takes it.
QG_INLINE vec2 in_picture(ImageBox box, vec3 inside) {
  return vec2(0.5f + 0.5f * inside.x / box.half_size.x, 0.5f - 0.5f * inside.y / box.half_size.y);
}

// How many of the finest texels of a picture in the box, a side, `width` mm are.
QG_INLINE float texels_across(ImageBox box, ImageLevels image, float width) {
  vec2 texel = 2.0f * vec2(box.half_size.x, box.half_size.y) / vec2(float(image.columns), float(image.rows));
  return width / max(min(texel.x, texel.y), 1e-20f);
}

#ifndef __cplusplus
vec3 load_image(Vec3s texels, ImageTap tap) {
  return mixed(tap, texels.at[tap.upper_left], texels.at[tap.upper_right], texels.at[tap.lower_left],
               texels.at[tap.lower_right]);
}
#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
