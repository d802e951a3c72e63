// The discretisations behind operator.h, one file each. Input is checked by the caller.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/file/graph.h"
#include "engine/reference/operator.h"

namespace quadgraph {

Rows assemble_fdm(const Level& level, const Problem& problem);
Rows assemble_fv(const Level& level, const Problem& problem);
Rows assemble_fem(const Level& level, const Problem& problem);
Rows assemble_polygrid(const Level& level, const Problem& problem);

// The measure that multiplies (k11, k12) source q in b: per carrier the sum over the open outside faces f of
// factor_f q_f, in the units of the method's rows.
std::vector<glm::dvec3> surface_load_fdm(const Level& level, const Problem& problem, std::span<const glm::vec3> q);
std::vector<glm::dvec3> surface_load_fv(const Level& level, std::span<const glm::vec3> q);
std::vector<glm::dvec3> surface_load_fem(const Level& level, std::span<const glm::vec3> q);

// Mass of 5/9 sigma_t per unit of volume, 1/mm: what phi2 loses.
glm::dvec3 relaxation_of(const gpu::Optical& optical);

}  // namespace quadgraph
