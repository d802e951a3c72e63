// How the passes that bring a picture to a screen count its brightness.
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

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
