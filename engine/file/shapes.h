// Displacements of all vertices of a body, the targets of a vertex animation.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

namespace quadgraph {

// The shapes of one mesh: a vector per shape, with a displacement per vertex, mm.
using ShapesOfMesh = std::vector<std::vector<glm::vec3>>;

struct Shapes {
  std::filesystem::path file{};  // where they are from; empty if from nowhere
  ShapesOfMesh display{};
  std::vector<ShapesOfMesh> levels{};  // of the tets' vertices, finest level first

  std::size_t count() const { return display.size(); }
};

// Reads a .qshapes file (docs/deformation.md), or gives the shapes that were read of it before if it is still the same.
// Throws FormatError naming the section and the broken rule, InputError if it cannot be read.
std::shared_ptr<const Shapes> load_shapes(const std::filesystem::path& path);

}  // namespace quadgraph
