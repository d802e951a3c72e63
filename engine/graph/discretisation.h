// The discretisations behind operator.h, one file each. Input is checked by the caller.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/graph/graph.h"
#include "engine/graph/operator.h"

namespace quadgraph {

Rows assemble_fdm(const Level& level, std::span<const gpu::Optical> optical, double eta);
std::vector<glm::dvec3> load_fdm(const Level& level, std::span<const gpu::Optical> optical, double eta,
                                 std::span<const glm::vec3> q);

Rows assemble_fv(const Level& level, std::span<const gpu::Optical> optical, double eta);
std::vector<glm::dvec3> load_fv(const Level& level, double eta, std::span<const glm::vec3> q);

Rows assemble_fem(const Level& level, std::span<const gpu::Optical> optical, double eta);
std::vector<glm::dvec3> load_fem(const Level& level, double eta, std::span<const glm::vec3> q);

}  // namespace quadgraph
