// Where the frames that make a picture together are taken from.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>

#include "engine/render/picture/pixel_filter.h"
#include "shaders/light/render_shared.h"

namespace quadgraph {

inline constexpr std::uint32_t samples_per_frame = 4;  // of each pixel, in the middles of its quarters

// One of the frames that make a picture.
struct PictureFrame {
  std::uint32_t index = 0, count = 1;
};

struct FrameOffset {
  glm::dvec2 pixel{0};  // by which the picture is moved, in pixels to the right and up
  glm::dvec2 lens{0};   // of a lens of radius 1
};

// All samples of a pixel together are spread by the weight of the filter, so that each counts alike (Ernst, Stamminger
// and Greiner 2006), as evenly as a Sobol sequence is; those of the lens as the seeds of a sunflower (Vogel 1979), in
// an order that goes over all of it again and again. A single frame has its four samples, whatever the filter.
FrameOffset frame_offset(const PictureFrame& frame, PixelFilter filter = PixelFilter::box);

// Where a frame tells what the body covers of a pixel that its silhouette may cross: pixels from the middle of the
// moved pixel, to the right and down. In each frame they are spread by the weight of the filter, as evenly as a Sobol
// sequence is, and in all frames together, too; a single frame has the box.
struct CoveragePlaces {
  std::array<glm::vec2, gpu::COVERAGE_PLACES> places;
  float reach;  // none is farther from the middle along an axis
};
CoveragePlaces coverage_places(const PictureFrame& frame, PixelFilter filter = PixelFilter::box);

}  // namespace quadgraph
