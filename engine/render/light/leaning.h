// How far the facets lean that a normal map makes the outside faces of, for light that enters by them.
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "engine/file/graph.h"
#include "engine/render/display/normal_map.h"

namespace quadgraph {

// Per level and outside face what shaders/source/leaning.glsl reads: the mean of the map over the face, so that what is
// finer in it does nothing. `own`: the map lies by coordinates of the display mesh, else in its box.
std::vector<std::vector<glm::vec2>> leaning_faces(const QuadGraph& graph, const NormalMap& map, bool own);

}  // namespace quadgraph
