// A place in every tet other than its middle.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "engine/file/graph.h"

namespace quadgraph {

// A point in each tet of a level, mm, drawn evenly over its volume; always the same.
std::vector<glm::vec3> points_in_tets(const Level& level);

}  // namespace quadgraph
