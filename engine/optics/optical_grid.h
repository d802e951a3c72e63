// Coefficients at the points of a regular grid.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "shaders/shared/shared.h"

namespace quadgraph {

// Linear between the points, beside them the nearest one's.
struct OpticalGrid {
  glm::uvec3 size{0};                     // points along x, y, z
  std::span<const gpu::Optical> optical;  // x fastest
  glm::vec3 spacing{1};                   // mm
  glm::vec3 first{0};                     // mm, where the first point is in the body at rest
  float eta = 1.3f;
};

}  // namespace quadgraph
