// Light inside a body and what view rays gather of it (engine/reference/radiance.h), with derivatives.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/derivative/parameters.h"
#include "engine/derivative/source.h"
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

// A level, its parameters, and what rays need of its shape.
struct Inside {
  const Level& level;
  const Problem& problem;
  const Parameters& at;
  const FollowedShape& shape;

  // Sets entry and depth.
  void uncollided(const Entering& light, InsideFields& fields) const;
  // The same for their derivatives along a direction, and of what enters again.
  void uncollided_tangent(const Parameters& along, const Entering& light, std::span<const glm::dvec3> again,
                          InsideFields& fields) const;
  // Adds the derivatives of weighted entries and depths to a gradient, and by what enters again.
  void uncollided_adjoint(const InsideFields& weights, const Entering& light, Parameters& gradient,
                          std::span<glm::dvec3> by_again) const;

  // W/(mm^2 sr) per sample: gathered_radiance.
  std::vector<glm::dvec3> gathered(const InsideFields& fields, std::span<const ViewSample> samples) const;
  // Its derivatives along a direction.
  std::vector<glm::dvec3> gathered_tangent(const InsideFields& fields, const Parameters& along,
                                           const InsideFields& change, std::span<const ViewSample> samples) const;
  // Adds the derivatives of weighted samples to a gradient, and by the fields.
  void gathered_adjoint(const InsideFields& fields, std::span<const glm::dvec3> weights,
                        std::span<const ViewSample> samples, Parameters& gradient, InsideFields& by_fields) const;
};

}  // namespace quadgraph
