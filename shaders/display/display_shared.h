// How the passes that bring a picture to a screen count its brightness.
#ifndef QUADGRAPH_DISPLAY_SHARED_H
#define QUADGRAPH_DISPLAY_SHARED_H

#include "display/tone_curve.h"
#include "light/render_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Luminance and brightest channel of covered pixels are counted in bins of equal ratio, of which the first begins at
// 2^LEAST_STOP: a quantile is then known within a 1/128 stop, less than a code of 8 bits.
const uint BINS_PER_STOP = 128u;
const float LEAST_STOP = -64.0f;
const uint LUMINANCE_BINS = 128u * BINS_PER_STOP;

// What a picture is shown with and before.
struct ShownWith {
  ToneTransform tone;
  vec3 background_top;  // linear display colour
  vec3 background_bottom;
};
#ifndef __cplusplus
QG_ARRAY(ShownWiths, ShownWith);

#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
