#include "engine/solve/importance.h"

#include <algorithm>
#include <cmath>

#include "engine/solve/surface_parts.h"

namespace quadgraph {
namespace {

// The least exitance, in its mean, to which no dimmer one is told apart; and the range of importances.
constexpr double least_exitance = 1e-6, least_importance = 1e-4, most_importance = 1e5;

// How much more a dim part of the surface counts: as the inverse of its exitance to this power. By 1 all patches are
// reached by as many walks, by 0 as many as light has it.
constexpr double evenness = 0.5;

// Per face and channel, means over patches.
std::vector<glm::dvec3> smooth_exitance(const Perturbation& perturbation, const SurfaceField& field) {
  std::vector<glm::dvec3> power(most_patches, glm::dvec3(0)), found(field.area.size());
  std::vector<double> area(most_patches, 0);
  const std::span<const std::uint32_t> patches = perturbation.patches();
  for (std::size_t f = 0; f < found.size(); ++f) {
    power[patches[f]] += double{field.area[f]} * glm::dvec3(field.exitance[f]);
    area[patches[f]] += field.area[f];
  }
  for (std::size_t f = 0; f < found.size(); ++f) found[f] = power[patches[f]] / area[patches[f]];
  return found;
}

glm::dvec3 mean_over_faces(const SurfaceField& field, std::span<const glm::vec3> values) {
  glm::dvec3 sum(0);
  double area = 0;
  for (std::size_t f = 0; f < values.size(); ++f) {
    sum += double{field.area[f]} * glm::dvec3(values[f]);
    area += field.area[f];
  }
  return sum / area;
}

// Light that comes from outside, as if the equation ran backwards: as much as a part counts.
std::vector<glm::vec3> load_of(const Perturbation& perturbation, const SurfaceField& field, const Level& level) {
  const std::vector<glm::dvec3> exitance = smooth_exitance(perturbation, field);
  const glm::dvec3 mean = mean_over_faces(field, field.exitance);
  std::vector<glm::dvec3> load(level.vertex_count(), glm::dvec3(0));
  for (std::size_t f = 0; f < exitance.size(); ++f) {
    for (int c = 0; c < 3; ++c) {
      if (!(mean[c] > 0)) continue;
      const double counts = std::pow(std::max(exitance[f][c] / mean[c], least_exitance), -evenness);
      for (int k = 0; k < 3; ++k) load[level.faces[f][k]][c] += counts * double{field.area[f]} / 3;
    }
  }
  return {load.begin(), load.end()};
}

}  // namespace

std::vector<glm::vec3> importance_of(Perturbation& perturbation, const PerturbedSolution& solution,
                                     const Level& level) {
  const SurfaceField& field = solution.field;
  std::vector<glm::vec3> found = perturbation.fluence(solution, load_of(perturbation, field, level));
  glm::dvec3 light(0), sum(0);
  for (std::size_t f = 0; f < field.area.size(); ++f) {
    glm::dvec3 here(0);
    for (int k = 0; k < 3; ++k) here += glm::max(glm::dvec3(found[level.faces[f][k]]), glm::dvec3(0)) / 3.0;
    const glm::dvec3 q = double{field.area[f]} * glm::dvec3(field.q[f]);
    light += q;
    sum += q * here;
  }
  for (int c = 0; c < 3; ++c) {
    const double mean = light[c] > 0 ? sum[c] / light[c] : 0;
    for (glm::vec3& value : found) {
      const double relative = mean > 0 ? double{value[c]} / mean : 1;
      value[c] = static_cast<float>(std::clamp(relative, least_importance, most_importance));
    }
  }
  return found;
}

}  // namespace quadgraph
