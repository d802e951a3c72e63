// Places in every tet other than its middle.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/base/listener.h"
#include "engine/file/graph.h"

namespace quadgraph {

// Points of each tet. A picture tells by more than one what few, large tets hold.
constexpr std::uint32_t points_of_a_tet = 4;

// Points in each tet of a level, mm, drawn evenly over its volume, always the same: one of every tet, then another one
// of every tet, and so on, tets * points_of_a_tet.
std::vector<glm::vec3> points_in_tets(const Level& level, const Listener& listener = {});

}  // namespace quadgraph
