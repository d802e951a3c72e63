// How deep places lie below the surface of a level.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/file/graph.h"

namespace quadgraph {

// Distance of each point to the nearest outside face, mm; on all cores.
std::vector<float> depth_below_surface(const Level& level, std::span<const glm::vec3> points);

}  // namespace quadgraph
