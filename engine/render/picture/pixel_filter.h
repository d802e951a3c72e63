// How samples around the middle of a pixel are weighed for it.
#pragma once

#include <array>

#include "engine/base/names.h"

namespace quadgraph {

enum class PixelFilter { box, tent, gaussian, blackman_harris };

template <>
struct Names<PixelFilter> {
  static constexpr std::string_view what = "filter";
  static constexpr auto values = std::to_array<Named<PixelFilter>>(
      {{PixelFilter::box, "box", "the mean over the pixel"},
       {PixelFilter::tent, "tent", "falls to 0 at the middles of the neighbours"},
       {PixelFilter::gaussian, "gaussian", "of a standard deviation of half a pixel, cut off at three of them"},
       {PixelFilter::blackman_harris, "blackman-harris", "the window of that name (Harris 1978), 3 pixels wide"}});
};

// Place, in pixels from the middle along an axis, below which the share `u` in (0, 1) of a filter's weight lies.
double quantile(PixelFilter filter, double u);

// Mean square of those places.
double variance(PixelFilter filter);

}  // namespace quadgraph
