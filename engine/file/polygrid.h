// The links between the vertices of a level that is a polygrid.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "engine/file/graph.h"

namespace quadgraph {

inline constexpr std::uint32_t no_layer = std::numeric_limits<std::uint32_t>::max();

// How many links, followed in the direction of the rows, each vertex is from the surface; no_layer where none lead
// there. Indices must be in range.
std::vector<std::uint32_t> grid_layers(const Level& level);

// The neighbour of each surface vertex.
std::vector<std::uint32_t> grid_neighbours(const Level& level);

}  // namespace quadgraph
