#include "engine/reference/block.h"

namespace quadgraph {

Block block_of(const Terms& terms, Model model, const Boundary& boundary) {
  Block block;
  block.a11 = terms.stiffness + terms.absorption + terms.boundary * boundary.k11;
  if (model == Model::diffusion) return block;
  block.a12 = 2.0 / 3.0 * terms.stiffness + terms.boundary * boundary.k12;
  block.a22 = 55.0 / 63.0 * terms.stiffness + terms.relaxation + terms.boundary * boundary.k22;
  return block;
}

Field solve(const Block& a, const Field& r) {
  if (a.a22 == glm::dvec3(0)) return {r.phi / a.a11, glm::dvec3(0)};
  const glm::dvec3 determinant = a.a11 * a.a22 - a.a12 * a.a12;
  return {(a.a22 * r.phi - a.a12 * r.phi2) / determinant, (a.a11 * r.phi2 - a.a12 * r.phi) / determinant};
}

}  // namespace quadgraph
