// The scale of gathered radiance: what it keeps, and below which distance it smooths.
#include "engine/reference/gather_scale.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "shaders/gather/gather_shared.h"
#include "tests/cpp/fixtures/graph_cases.h"
#include "tests/cpp/fixtures/test_graphs.h"

using namespace quadgraph;

namespace {

Opticals medium(const Level& level, float sigma_t) {
  return Opticals(level.nodes.size(), {glm::vec3(0.9f * sigma_t), glm::vec3(0.1f * sigma_t)});
}

Problem problem_of(const Opticals& optical) {
  return {Method::fem, Source::buried, Model::sp3, optical, 1.0};
}

}  // namespace

TEST_CASE("an even ratio is kept, up to the largest factor, and what is then missing is the rest") {
  const OwnedLevel owned = box_level(4, 10.0f, 0.3f);
  const Level level = owned.view();
  const std::vector<glm::dvec3> gathered(level.faces.size(), {2.0, 1.0, 0.0});
  const std::vector<glm::dvec3> exitance(level.surface_vertex_count, {3.0, 8.0, 0.5});
  for (const float sigma_t : {0.1f, 10.0f}) {
    const Opticals optical = medium(level, sigma_t);
    for (const VertexScale& scale : gather_scale(level, problem_of(optical), gathered, exitance)) {
      CHECK(scale.factor.x == doctest::Approx(1.5).epsilon(1e-9));
      CHECK(scale.rest.x == doctest::Approx(0.0));
      CHECK(scale.factor.y == doctest::Approx(gpu::GATHER_FACTOR_MAX));
      CHECK(scale.rest.y == doctest::Approx(8.0 - double{gpu::GATHER_FACTOR_MAX}).epsilon(1e-6));
      CHECK(scale.factor.z == 0.0);
      CHECK(scale.rest.z == doctest::Approx(0.5).epsilon(1e-9));
    }
  }
}

TEST_CASE("radiance has a floor where edges are long, and none where they resolve a few mean free paths") {
  const OwnedLevel owned = box_level(4, 10.0f);
  const Level level = owned.view();
  const std::vector<glm::dvec3> gathered(level.faces.size(), glm::dvec3(1));
  const std::vector<glm::dvec3> exitance(level.surface_vertex_count, glm::dvec3(3));
  const double rms_edge = 2.5 * std::sqrt(4.0 / 3);  // of a square's halves
  for (const auto& [lengths, least] :
       {std::pair(1.9, 0.0), std::pair(3.0, 0.6), std::pair(4.0, 1.2), std::pair(40.0, 1.2)}) {
    const Opticals optical = medium(level, static_cast<float>(lengths / rms_edge));
    for (const VertexScale& scale : gather_scale(level, problem_of(optical), gathered, exitance)) {
      CHECK(scale.least.x == doctest::Approx(least).epsilon(1e-5));
    }
  }
}

TEST_CASE("the exitance counts over a mean free path: below it is smoothed, above it is followed") {
  // On a box of 10 mm the exitance doubles from one half to the other.
  const OwnedLevel owned = box_level(10, 10.0f);
  const Level level = owned.view();
  const std::vector<glm::dvec3> gathered(level.faces.size(), glm::dvec3(1));
  std::vector<glm::dvec3> exitance;
  for (std::uint32_t v = 0; v < level.surface_vertex_count; ++v) {
    exitance.emplace_back(level.vertices[v].y < 4.5f ? 1.0 : 2.0);
  }
  const auto factor_at = [&](float sigma_t, float y) {
    const Opticals optical = medium(level, sigma_t);
    const auto scale = gather_scale(level, problem_of(optical), gathered, exitance);
    for (std::uint32_t v = 0; v < level.surface_vertex_count; ++v) {
      if (glm::distance(level.vertices[v], glm::vec3(0, y, 5)) < 1e-3f) return scale[v].factor.x;
    }
    return 0.0;
  };
  // Mean free paths of .2 and 1 mm, two and more away from the step.
  for (const float sigma_t : {5.0f, 1.0f}) {
    CHECK(factor_at(sigma_t, 1.0f) == doctest::Approx(1.0).epsilon(0.01));
    CHECK(factor_at(sigma_t, 8.0f) == doctest::Approx(2.0).epsilon(0.01));
  }
  // A mean free path of 20 mm is larger than the body.
  CHECK(factor_at(0.05f, 8.0f) / factor_at(0.05f, 1.0f) < 1.1);
  CHECK(factor_at(0.05f, 8.0f) > factor_at(0.05f, 1.0f));
  CHECK(factor_at(0.05f, 5.0f) == doctest::Approx(1.55).epsilon(0.05));
}

TEST_CASE("every vertex has its share, however long and thin the faces around it") {
  // A box drawn out to needles, much longer than the mean free path.
  OwnedLevel owned = box_level(3, 1.0f, 0.3f);
  for (auto* points : {&owned.vertices, &owned.nodes}) {
    for (glm::vec3& p : *points) p.x *= 200.0f;
  }
  const Level level = owned.view();
  const std::vector<glm::dvec3> gathered(level.faces.size(), glm::dvec3(1));
  const std::vector<glm::dvec3> exitance(level.surface_vertex_count, glm::dvec3(2));
  const Opticals optical = medium(level, 1e3f);
  for (const VertexScale& scale : gather_scale(level, problem_of(optical), gathered, exitance)) {
    CHECK(scale.factor.x == doctest::Approx(2.0).epsilon(1e-9));
  }
}
