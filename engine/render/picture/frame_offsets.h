// Where the frames that make a picture together are taken from.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

namespace quadgraph {

inline constexpr std::uint32_t samples_per_frame = 4;  // of each pixel, in the middles of its quarters

// One frame of `count`.
struct FrameOffset {
  glm::dvec2 pixel{0};  // by which the picture is moved, within a quarter of a pixel around 0; their mean is 0
  glm::dvec2 lens{0};   // of a lens of radius 1
};

// All samples of a pixel together are spread as evenly over it as a Sobol sequence is, those of the lens as the seeds
// of a sunflower (Vogel 1979), in an order that goes over all of it again and again.
FrameOffset frame_offset(std::uint32_t index, std::uint32_t count);

}  // namespace quadgraph
