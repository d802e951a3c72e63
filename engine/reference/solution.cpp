#include "engine/reference/solution.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "engine/file/geometry.h"

namespace quadgraph {

glm::dvec3 Energy::balance() const {
  glm::dvec3 result{0};
  for (int c = 0; c < 3; ++c) {
    if (!(entered[c] > 0)) continue;
    const double out = scattered_out[c] + absorbed[c] + unscattered_out[c];
    result[c] = (entered[c] + re_entered[c] - out) / entered[c];
  }
  return result;
}

std::vector<std::string> unmet(const SolveReport& report) {
  std::vector<std::string> all;
  for (const std::string& sentence : {report.missed, report.stopped}) {
    if (!sentence.empty()) all.push_back(sentence);
  }
  return all;
}

bool fails(const SolveReport& report, bool strict) {
  return !report.stopped.empty() || (strict && !report.missed.empty());
}

SurfaceField surface_of(const Level& level) {
  SurfaceField field;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::dvec3 normal = face_vector(level, level.faces[f]);
    field.position.push_back(level.nodes[level.tet_count() + f]);
    field.normal.push_back(glm::vec3(normal / std::max(glm::length(normal), 1e-300)));
    field.area.push_back(static_cast<float>(0.5 * glm::length(normal)));
  }
  return field;
}

}  // namespace quadgraph
