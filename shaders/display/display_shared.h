// Types of the passes that bring a picture to a screen, in scalar layout; tests/cpp/render/layout_test.cpp compares
// them with the compiled shaders.
#ifndef QUADGRAPH_DISPLAY_SHARED_H
#define QUADGRAPH_DISPLAY_SHARED_H

#include "light/render_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Luminance and brightest channel of covered pixels are counted in bins of equal ratio, of which the first begins at
// 2^LEAST_STOP: a quantile is then known within a 1/128 stop, less than a code of 8 bits.
const uint BINS_PER_STOP = 128u;
const float LEAST_STOP = -64.0f;
const uint LUMINANCE_BINS = 128u * BINS_PER_STOP;

// luminance.comp: counts of the covered pixels of a picture, by luminance and by their brightest channel.
struct LuminancePush {
  QG_REF(Floats) layers[PICTURE_LAYERS];  // RGB per pixel
  QG_REF(Floats) alpha;                   // per pixel
  QG_REF(Uints) bins;  // LUMINANCE_BINS twice, added to; what is below the first or black is in the first
  uint count;          // pixels
};

// tone_map.comp: a picture as engine/render/picture/png_file.cpp's to_srgb8 shows it, stretched to a part of a screen.
struct ToneMapPush {
  QG_REF(Floats) layers[PICTURE_LAYERS];  // RGB per pixel
  QG_REF(Floats) alpha;                   // per pixel
  QG_REF(Floats) surroundings;            // RGB per pixel
  QG_REF(Uints) target;                   // per pixel of the screen's part, 8 bits each, the first lowest; written
  vec3 background_top;                    // linear display colour
  vec3 background_bottom;
  float exposure;  // radiance is multiplied by it
  uint picture_width;
  uint picture_height;
  uint width;  // pixels of the screen's part
  uint height;
  uint false_colour;  // 1: the first layer is linear display colour
  uint blue_first;    // order of the channels: 1 blue, green, red; 0 red, green, blue
  uint surrounded;    // 1: surroundings are seen instead of a background
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
