// Linear elements by what the operator takes of every tet, in which it is linear.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/reference/operator.h"

namespace quadgraph {

struct ElementCoefficients {
  glm::dvec3 kappa{0};       // mm
  glm::dvec3 absorption{0};  // sigma_a, 1/mm
  glm::dvec3 relaxation{0};  // 5/9 sigma_t, 1/mm
};

// Rows of `fem` (operator.h), of one entry per tet.
Rows assemble_elements(const Level& level, std::span<const ElementCoefficients> elements, Model model,
                       const Boundary& boundary);

// Per tet what the coefficients are multiplied by in left^T A right.
std::vector<ElementCoefficients> element_products(const Level& level, std::span<const Field> left,
                                                  std::span<const Field> right, Model model);

}  // namespace quadgraph
