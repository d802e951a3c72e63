// Light that has left a body and meets it again; `Value` as in exitance.h. See exchange.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/reference/exitance.h"

namespace quadgraph {

// Faces that the rays from outside face f meet, one entry for each ray.
inline std::span<const std::uint32_t> seen_from(const Level& level, std::uint32_t f) {
  return level.seen.subspan(level.seen[f], level.seen[f + 1] - level.seen[f]);
}

// E, W/mm^2 per outside face, from J, W/mm^2 per outside face: the mean of J over the rays of a face, scaled by one
// factor per channel so that as much light arrives as left towards the body: sum A E = sum A J (1 - sky). Nothing
// arrives at reflecting faces. `level` must have rows `seen`.
template <class Value>
std::vector<Value> received_irradiance(const Level& level, std::span<const Value> radiosity) {
  std::vector<Value> irradiance(level.faces.size(), Value(0));
  Value sent(0), arrived(0);
  const double rays = level.seen_rays;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    const auto seen = seen_from(level, f);
    for (const std::uint32_t face : seen) irradiance[f] = irradiance[f] + radiosity[face];
    irradiance[f] = irradiance[f] * (1 / rays);
    const double area = face_area(level, level.faces[f]);
    sent = sent + radiosity[f] * (area * (static_cast<double>(seen.size()) / rays));
    arrived = arrived + irradiance[f] * area;
  }
  const Value factor = safe_ratio(sent, arrived);
  for (Value& e : irradiance) e = e * factor;
  return irradiance;
}

inline std::vector<glm::dvec3> received_irradiance(const Level& level, const std::vector<glm::dvec3>& radiosity) {
  return received_irradiance<glm::dvec3>(level, std::span(radiosity));
}

}  // namespace quadgraph
