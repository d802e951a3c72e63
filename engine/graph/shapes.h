// Displacements of all vertices of a body, the targets of a vertex animation.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace quadgraph {

// Of one mesh, one vector per shape, of one displacement per vertex, mm.
using ShapesOfMesh = std::vector<std::vector<glm::vec3>>;

struct Shapes {
  ShapesOfMesh display;
  std::vector<ShapesOfMesh> levels;  // of the tets' vertices, finest level first

  std::size_t count() const { return display.size(); }
};

}  // namespace quadgraph
