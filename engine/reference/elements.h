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

// What the operator takes of a tet.
ElementCoefficients element_of(const gpu::Optical& optical);

// Adds to `sum`, per vertex, the product of one tet's rows of diffusion with a field at the vertices.
void add_element_product(const Level& level, const glm::uvec4& tet, const ElementCoefficients& element,
                         std::span<const glm::vec3> field, std::span<glm::dvec3> sum);

// Rows of `fem` (operator.h), of one entry per tet.
Rows assemble_elements(const Level& level, std::span<const ElementCoefficients> elements, Model model,
                       const Boundaries& boundaries);

// Per tet what the coefficients are multiplied by in left^T A right.
std::vector<ElementCoefficients> element_products(const Level& level, std::span<const Field> left,
                                                  std::span<const Field> right, Model model);

}  // namespace quadgraph
