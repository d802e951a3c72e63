// What derivatives are taken by, and of what.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

namespace quadgraph {

// Values, or derivatives by them, per channel.
struct Parameters {
  std::vector<glm::dvec3> scattering;  // sigma_s' of every tet, 1/mm
  std::vector<glm::dvec3> absorption;  // sigma_a of every tet, 1/mm
  std::vector<glm::dvec3> power;       // of every light, in units of what it is given with

  Parameters() = default;
  Parameters(std::size_t tets, std::size_t lights)
      : scattering(tets, glm::dvec3(0)), absorption(tets, glm::dvec3(0)), power(lights, glm::dvec3(0)) {}
};

// Light that leaves a body, its derivatives, or weights of both.
struct Outgoing {
  std::vector<glm::dvec3> exitance;     // W/mm^2 per outside face, 0 at reflecting ones: flux of ReferenceSolution
  std::vector<glm::dvec3> unscattered;  // the same, of light that was not scattered
  std::vector<glm::dvec3> radiance;     // W/(mm^2 sr) per view sample: gathered_radiance

  Outgoing(std::size_t faces, std::size_t samples)
      : exitance(faces, glm::dvec3(0)), unscattered(faces, glm::dvec3(0)), radiance(samples, glm::dvec3(0)) {}
};

}  // namespace quadgraph
