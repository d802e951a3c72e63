// What leaves the outside faces, from values at the carriers; `Value` is all channels in one (glm::dvec3), or a number
// of medium.h, of one channel.
#pragma once

#include <cstdint>
#include <glm/common.hpp>
#include <span>
#include <vector>

#include "engine/file/geometry.h"
#include "engine/reference/operator.h"

namespace quadgraph {

inline glm::dvec3 positive(const glm::dvec3& value) {
  return glm::max(value, glm::dvec3(0));
}

// The mean of `values` (per carrier) over outside face f.
template <class Value>
Value at_face(const Level& level, Method method, std::span<const Value> values, std::uint32_t f) {
  if (!on_vertices(method)) return values[level.tet_count() + f];
  const glm::uvec3& face = level.faces[f];
  return (values[face[0]] + values[face[1]] + values[face[2]]) * (1.0 / 3);
}

// The same at all open faces; 0 at the others.
template <class Value>
std::vector<Value> over_faces(const Level& level, Method method, std::span<const Value> values) {
  std::vector<Value> faces(level.faces.size(), Value(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (!level.reflecting(f)) faces[f] = at_face(level, method, values, f);
  }
  return faces;
}

template <class Value>
Value surface_integral(const Level& level, std::span<const Value> faces) {
  Value sum(0);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) sum = sum + faces[f] * face_area(level, level.faces[f]);
  return sum;
}

// M >= 0 at the faces for the buried source: negative values at the carriers become 0, the others pay for them.
// `clipped`: what became 0, as a share of what was above.
template <class Value>
std::vector<Value> clipped_exitance(const Level& level, Method method, std::vector<Value> carriers, Value& clipped) {
  const auto faces_of = [&] { return over_faces(level, method, std::span<const Value>(carriers)); };
  const Value raw = surface_integral(level, std::span<const Value>(faces_of()));
  for (Value& m : carriers) m = positive(m);
  std::vector<Value> faces = faces_of();
  const Value above = surface_integral(level, std::span<const Value>(faces));
  const Value factor = safe_ratio(positive(raw), above);
  for (Value& m : faces) m = m * factor;
  clipped = safe_ratio(above - raw, above);
  return faces;
}

}  // namespace quadgraph
