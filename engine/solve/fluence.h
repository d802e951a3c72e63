// Fluence of the last solve in the body, whatever its method has for unknowns.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/device/device.h"
#include "engine/solve/simulation.h"
#include "shaders/shared/shared.h"

namespace quadgraph {

// Fluence of light that was scattered, at the carriers of the last solve's method on level 0 in its present shape.
struct Fluence {
  std::vector<glm::vec3> points;  // mm; vertices of the tets, or the nodes, those of tets first (on_vertices)
  std::vector<glm::vec3> values;  // W/mm^2
};

// `method`: that of the last solve, which must have gone over level 0. Throws InputError before a solve.
Fluence fluence(Simulation& simulation, Method method);

// Fluence of scattered light at `points`, mm, W/mm^2: linear in the tets where the carriers are their vertices, else
// one value in each tet, its node's; NaN outside the body (engine/reference/tet_locator.h). `check` is called now and
// then; what it throws ends the search.
std::vector<glm::vec3> fluence_at(Simulation& simulation, Method method, std::span<const glm::vec3> points,
                                  const std::function<void()>& check = {});

// Coefficients in the tets of level 0 that the last solve was for, edits among them, 1/mm; one per tet. Throws
// InputError before a solve.
std::vector<gpu::Optical> tet_coefficients(device::Device& device, const Simulation& simulation,
                                           std::uint32_t level = 0);

}  // namespace quadgraph
