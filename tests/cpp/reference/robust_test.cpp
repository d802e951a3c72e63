// The reference where methods fail: slivers, contrasts, clear and black regions, elements of any size.
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "tests/cpp/fixtures/graph_cases.h"
#include "tests/cpp/fixtures/test_graphs.h"

using namespace quadgraph;

namespace {

void check_answer(const Level& level, const Opticals& optical, double eta, Method method, Model model) {
  CAPTURE(name_of(method));
  CAPTURE(name_of(model));
  const auto q = one_side(level);
  const auto solution = solve_reference(level, optical, eta, along_x(q), solving(method, Source::buried, model, 1e-10));
  CHECK(solution.report.converged);
  for (int c = 0; c < 3; ++c) {
    CHECK(std::abs(solution.energy.balance()[c]) < 1e-7);
    CHECK(solution.energy.entered[c] > 0);
  }
  for (const glm::dvec3& m : solution.exitance) {
    for (int c = 0; c < 3; ++c) {
      CHECK(std::isfinite(m[c]));
      CHECK(m[c] >= 0);
    }
  }
}

void check_all(const Level& level, const Opticals& optical, double eta = 1.3) {
  for (Method method : {Method::fem, Method::quadgraph_fv}) {
    for (Model model : both_models) check_answer(level, optical, eta, method, model);
  }
}

// One of two sets of coefficients per tet, at random; the surface nodes take that of their tet.
Opticals alternating(const Level& level, const gpu::Optical& a, const gpu::Optical& b) {
  std::mt19937 random(11);
  Opticals optical;
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) optical.push_back(random() % 2 == 0 ? a : b);
  for (const std::uint32_t t : level.face_tets) optical.push_back(optical[t]);
  return optical;
}

}  // namespace

TEST_CASE("kappa jumps by 10^4 between neighbouring tets") {
  const OwnedLevel owned = box_level(4, 4.0f, 0.3f);
  const Level level = owned.view();
  check_all(level, alternating(level, {glm::vec3(0.01f), glm::vec3(1e-4f)}, {glm::vec3(100.0f), glm::vec3(1e-4f)}));
}

TEST_CASE("sigma_a jumps by 10^4 between neighbouring tets") {
  const OwnedLevel owned = box_level(4, 4.0f, 0.3f);
  const Level level = owned.view();
  check_all(level, alternating(level, {glm::vec3(1.0f), glm::vec3(1e-3f)}, {glm::vec3(1.0f), glm::vec3(10.0f)}));
}

TEST_CASE("no absorption at all, and absorption far above scattering") {
  const OwnedLevel owned = box_level(4, 4.0f, 0.3f);
  const Level level = owned.view();
  check_all(level, Opticals(level.nodes.size(), {glm::vec3(2.0f), glm::vec3(0)}));
  check_all(level, Opticals(level.nodes.size(), {glm::vec3(0.01f), glm::vec3(10.0f)}));
}

TEST_CASE("a clear inclusion, and a body that is clear all through") {
  const OwnedLevel owned = box_level(5, 5.0f, 0.3f);
  const Level level = owned.view();
  Opticals optical;
  for (const glm::vec3& p : level.nodes) {
    const bool inside = glm::all(glm::lessThan(glm::abs(p - glm::vec3(2.5f)), glm::vec3(1.3f)));
    optical.push_back(inside ? gpu::Optical{glm::vec3(0), glm::vec3(0)} : gpu::Optical{glm::vec3(2), glm::vec3(0.01f)});
  }
  check_all(level, optical);
  check_all(level, Opticals(level.nodes.size(), {glm::vec3(0), glm::vec3(0)}));
}

TEST_CASE("mean free paths of 0.01 to 100 elements") {
  const OwnedLevel owned = box_level(4, 4.0f, 0.3f);
  const Level level = owned.view();
  for (const float sigma : {100.0f, 10.0f, 1.0f, 0.1f, 0.01f}) {
    CAPTURE(sigma);
    check_all(level, Opticals(level.nodes.size(), {glm::vec3(0.99f * sigma), glm::vec3(0.01f * sigma)}));
  }
}

TEST_CASE("indices from 1 to 3") {
  const OwnedLevel owned = box_level(3, 4.0f, 0.3f);
  const Level level = owned.view();
  for (const double eta : {1.0, 1.001, 2.0, 3.0}) check_all(level, varying(level, 0.05f), eta);
}

TEST_CASE("slivers with dihedral angles of 0.1 degrees, and a needle") {
  OwnedLevel owned = box_level(3, 3.0f);
  for (glm::vec3& p : owned.vertices) {
    const bool inside = glm::all(glm::greaterThan(p, glm::vec3(0.1f))) && glm::all(glm::lessThan(p, glm::vec3(2.9f)));
    if (inside && p.x < 1.5f) p.x = 0.002f;  // the first layer of cells becomes a sheet of 0.002 mm
  }
  for (std::size_t t = 0; t < owned.tets.size(); ++t) {
    const glm::uvec4& tet = owned.tets[t];
    owned.nodes[t] =
        (owned.vertices[tet[0]] + owned.vertices[tet[1]] + owned.vertices[tet[2]] + owned.vertices[tet[3]]) / 4.0f;
  }
  check_all(owned.view(), varying(owned.view(), 0.05f));
  OwnedLevel needle = box_level(3, 3.0f);
  for (auto* points : {&needle.vertices, &needle.nodes}) {
    for (glm::vec3& p : *points) p *= glm::vec3(10.0f, 0.003f, 0.003f);
  }
  check_all(needle.view(), varying(needle.view(), 0.05f));
}

TEST_CASE("one tet, and two bodies that do not touch") {
  const OwnedLevel one = level_from_tets({{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 1, 2, 3}});
  check_all(one.view(), Opticals(one.nodes.size(), {glm::vec3(2), glm::vec3(0.1f)}));
  const OwnedLevel box = box_level(2, 2.0f);
  std::vector<glm::vec3> vertices = box.vertices;
  std::vector<glm::uvec4> tets = box.tets;
  for (const glm::vec3& p : box.vertices) vertices.push_back(p + glm::vec3(5, 0, 0));
  for (const glm::uvec4& t : box.tets) tets.push_back(t + glm::uvec4(static_cast<unsigned>(box.vertices.size())));
  const OwnedLevel two = level_from_tets(std::move(vertices), std::move(tets));
  check_all(two.view(), varying(two.view(), 0.05f));
}
