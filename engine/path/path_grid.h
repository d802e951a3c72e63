// The cells around a body.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "shaders/path/path_shared.h"

namespace quadgraph {

// Cubes of which `cells` fill the longest side of the box from `low` to `high`, mm, with at least one more on either
// side, the box in their middle.
gpu::PathGrid grid_around(const glm::vec3& low, const glm::vec3& high, std::uint32_t cells);

// Blocks of a grid.
std::uint32_t block_count(const gpu::PathGrid& grid);

}  // namespace quadgraph
