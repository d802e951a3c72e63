// The edge of what a body covers of the picture, to show which one is chosen.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "engine/file/graph.h"
#include "engine/render/display/camera.h"

namespace quadgraph {

using Segment = std::array<glm::vec2, 2>;  // clip coordinates

// Around what body number `body` of the file covers, whatever lies before it, seen from `camera` in a picture of this
// shape (width / height): to about a 400th of its height. `vertices`: of the display mesh where they are now, mm. Empty
// where it is not seen.
std::vector<Segment> outline_of(const QuadGraph& graph, std::span<const glm::vec3> vertices, std::uint32_t body,
                                const Camera& camera, float aspect);

}  // namespace quadgraph
