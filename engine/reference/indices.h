// Indices of refraction of the bodies of a file, inside over outside.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "engine/file/graph.h"
#include "engine/optics/boundary.h"

namespace quadgraph {

// A value for all bodies, or one for each.
template <typename T>
struct OfBodies {
  std::vector<T> values;  // one, or one per body

  const T& of(std::uint32_t body) const { return values[values.size() == 1 ? 0 : body]; }
  const T& behind(const Level& level, std::uint32_t face) const { return of(level.body_of_face(face)); }
};

struct Indices : OfBodies<double> {
  Indices(double all) : OfBodies{{all}} {}
  explicit Indices(std::vector<double> by_body) : OfBodies{std::move(by_body)} {}
};

using Boundaries = OfBodies<Boundary>;

}  // namespace quadgraph
