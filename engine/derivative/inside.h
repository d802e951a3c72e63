// Light inside a body and what view rays gather of it (engine/reference/radiance.h), with derivatives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/derivative/parameters.h"
#include "engine/derivative/source.h"
#include "engine/derivative/sparse_rows.h"
#include "engine/file/graph.h"
#include "engine/reference/follower.h"

namespace quadgraph {

// A ray that leaves the body, against whose way light is gathered.
struct ViewSample {
  std::uint32_t face = 0;     // an open one
  glm::dvec3 barycentric{0};  // of its start on the face
  glm::dvec3 outside{0};      // unit, away from the face
};

// Per vertex: values, derivatives, or weights.
struct InsideFields {
  std::vector<glm::dvec3> phi;    // W/mm^2, of light that has scattered
  std::vector<glm::dvec3> entry;  // W/mm^2, of light that has not (Uncollided)
  std::vector<glm::dvec3> depth;

  explicit InsideFields(std::size_t vertices)
      : phi(vertices, glm::dvec3(0)), entry(vertices, glm::dvec3(0)), depth(vertices, glm::dvec3(0)) {}
};

// What light inside depends on, one after the other, as inputs of the rows below: parameters, and what enters again.
struct InsideInputs {
  std::size_t tets = 0, lights = 0, again = 0;

  InsideInputs(const Parameters& at, std::size_t faces)
      : tets(at.scattering.size()), lights(at.power.size()), again(faces) {}

  std::size_t count() const { return 2 * tets + lights + again; }
  // `again`: per outside face, or empty where nothing enters again.
  std::vector<glm::dvec3> joined(const Parameters& parameters, std::span<const glm::dvec3> q) const;
  void add(std::span<const glm::dvec3> inputs, Parameters& parameters, std::span<glm::dvec3> q) const;
};

// A level, its parameters, and what rays need of its shape.
struct Inside {
  const Level& level;
  const Problem& problem;
  const Parameters& at;
  const FollowedShape& shape;

  // Sets entry and depth.
  void uncollided(const Entering& light, InsideFields& fields) const;
  // Their derivatives by InsideInputs: of each vertex a row for the entry and one for the depth.
  SparseRows uncollided_rows(const Entering& light) const;

  // W/(mm^2 sr) per sample: gathered_radiance.
  std::vector<glm::dvec3> gathered(const InsideFields& fields, std::span<const ViewSample> samples) const;
  // Its derivatives, a row a sample: by sigma_s' and sigma_a of the tets, then phi, entry and depth of the vertices.
  SparseRows gathered_rows(const InsideFields& fields, std::span<const ViewSample> samples) const;
};

}  // namespace quadgraph
