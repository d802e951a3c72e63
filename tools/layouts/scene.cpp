#include "tools/layouts/scene.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/file/geometry.h"
#include "engine/optics/material.h"
#include "engine/reference/reference.h"
#include "engine/reference/source_walk.h"

namespace quadgraph::layouts {
namespace {

constexpr float cell_mm = 10;

double contrast_of(const std::string& text) {
  std::size_t used = 0;
  double contrast = 0;
  try {
    contrast = std::stod(text, &used);
  } catch (const std::logic_error&) {
  }
  if (used != text.size() || !(contrast > 0 && std::isfinite(contrast))) {
    throw InputError("material 'checker:" + text + "': the contrast must be a number > 0");
  }
  return contrast;
}

}  // namespace

Scene scene_of(const Level& level, const std::string& material) {
  const std::string prefix = "checker:";
  const bool checker = material.rfind(prefix, 0) == 0;
  const float contrast = checker ? static_cast<float>(contrast_of(material.substr(prefix.size()))) : 1.0f;
  const gpu::Material parsed = parse_material(checker ? "marble" : material);
  const auto at = [&](std::span<const glm::vec3> positions) {
    std::vector<gpu::Optical> optical = evaluate_material(level, parsed, positions);
    for (std::size_t i = 0; i < optical.size(); ++i) {
      const glm::ivec3 cell(glm::floor(positions[i] / cell_mm));
      if ((cell.x + cell.y + cell.z) % 2 != 0) optical[i].sigma_a *= contrast;
    }
    return optical;
  };
  return {at(level.nodes), at(level.vertices), parsed.eta};
}

Light light_of(const Level& level, const Problem& problem) {
  const glm::vec3 direction = glm::normalize(glm::vec3(-1));
  Light light;
  for (const glm::uvec3& face : level.faces) {
    const glm::vec3 normal = glm::normalize(glm::cross(level.vertices[face[1]] - level.vertices[face[0]],
                                                       level.vertices[face[2]] - level.vertices[face[0]]));
    light.q.push_back(glm::vec3(std::max(0.0f, -glm::dot(normal, direction))));
  }
  std::vector<Quarters> quarters;
  for (const glm::vec3& q : light.q) quarters.push_back({q, q, q, q});
  const WalkResult walk = walk_source(level, problem, {gpu::BEAM_DIRECTIONAL, direction, {}, {}}, quarters);
  light.b = buried_load(level, problem, walk.scattered);
  return light;
}

ExitanceError exitance_error(const Level& level, const Boundary& boundary, const Light& light, std::span<const Field> x,
                             std::span<const Field> exact) {
  const auto at_face = [&](std::span<const Field> fields, const glm::uvec3& face) {
    glm::dvec3 sum{0};
    for (int k = 0; k < 3; ++k) sum += boundary.k11 * fields[face[k]].phi + boundary.k12 * fields[face[k]].phi2;
    return sum / 3.0;
  };
  double lit = 0, area = 0;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    area += face_area(level, level.faces[f]);
    lit += face_area(level, level.faces[f]) * static_cast<double>(light.q[f].x);
  }
  glm::dvec2 difference{0}, norm{0};  // whole, unlit
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::dvec3 m = at_face(exact, level.faces[f]), d = at_face(x, level.faces[f]) - m;
    const double a = face_area(level, level.faces[f]);
    const glm::dvec2 part(a, light.q[f].x < 0.1 * lit / area ? a : 0.0);
    difference += part * glm::dot(d, d);
    norm += part * glm::dot(m, m);
  }
  return {std::sqrt(difference[0] / norm[0]), std::sqrt(difference[1] / norm[1])};
}

}  // namespace quadgraph::layouts
