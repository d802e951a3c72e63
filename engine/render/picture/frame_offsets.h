// Where the frames that make a picture together are taken from.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

#include "engine/render/picture/pixel_filter.h"

namespace quadgraph {

inline constexpr std::uint32_t samples_per_frame = 4;  // of each pixel, in the middles of its quarters

// One frame of `count`.
struct FrameOffset {
  glm::dvec2 pixel{0};  // by which the picture is moved, in pixels
  glm::dvec2 lens{0};   // of a lens of radius 1
};

// All samples of a pixel together are spread by the weight of the filter, so that each counts alike (Ernst, Stamminger
// and Greiner 2006), as evenly as a Sobol sequence is; those of the lens as the seeds of a sunflower (Vogel 1979), in
// an order that goes over all of it again and again. A single frame has its four samples, whatever the filter.
FrameOffset frame_offset(std::uint32_t index, std::uint32_t count, PixelFilter filter = PixelFilter::box);

}  // namespace quadgraph
