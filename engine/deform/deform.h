// What a list of deformers makes of the vertices of a mesh, on the CPU in double precision: the answer the GPU is
// compared with; and the lists as the GPU takes them.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "engine/deform/deformer.h"
#include "engine/file/graph.h"
#include "shaders/deform/deform_shared.h"

namespace quadgraph {

// Which mesh of a body: a level, or without a number the display mesh.
using MeshNumber = std::optional<std::uint32_t>;

// A deformer without what `control` and `weight` point at.
gpu::DeformRecord deform_record(const Deformer& deformer, const RestBox& rest);

// Displacements of the control points of a lattice or of the vertices of a cage, mm; of `placed` the rows of the
// rotation and the shift of each body; empty for other kinds.
std::vector<glm::dvec3> control_displacements(const Deformer& deformer);

// Displacements of a `displaced` deformer that check_shapes has passed, mm for each of the mesh's `count` vertices.
std::vector<glm::vec3> shape_displacements(const Deformer& deformer, MeshNumber mesh, std::size_t count);

// The body of each vertex of a mesh, of a `placed` deformer.
std::span<const std::uint32_t> bodies_of(const Deformer& deformer, MeshNumber mesh);

// Throws InputError if a `displaced` deformer has shapes of another body.
void check_shapes(std::span<const Deformer> list, const QuadGraph& graph);

// Weights of a cage at the vertices of a mesh at rest: of control k at vertex v, at k * vertices + v.
std::vector<float> cage_weights(const Deformer& cage, std::span<const glm::vec3> vertices);

// The vertices of a mesh, moved. `list` has been checked. A cage takes its weights at the vertices at rest, whatever
// comes before it in the list.
std::vector<glm::dvec3> deformed(std::span<const Deformer> list, const RestBox& rest, MeshNumber mesh,
                                 std::span<const glm::vec3> vertices);

}  // namespace quadgraph
