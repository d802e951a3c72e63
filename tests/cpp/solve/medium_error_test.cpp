// What it costs that every tet has one value of each coefficient: the load that tells it, and what is said of it.
#include "engine/solve/medium_error.h"

#include <cmath>

#include "engine/reference/operator.h"
#include "engine/reference/tet_points.h"
#include "shaders/material/material.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

using namespace quadgraph;

namespace {

gpu::Material checker(float period) {
  gpu::Material material = homogeneous(0.02f);
  material.pattern = gpu::PATTERN_CHECKER;
  material.second_sigma_s_prime = 4.0f * material.sigma_s_prime;
  material.second_sigma_a = 6.0f * material.sigma_a;
  material.period = period;
  material.sharpness = 1;
  return material;
}

// What is told of the mesh is told of the solve that sweeps begin with: few points do.
const SolveOptions few_points = {.correction = true, .sweeps = 1, .sweep_points = 1000};

SolveReport solved(Scene& scene, const gpu::Material& material) {
  scene.simulation.set_material(material);
  scene.light(one_side);
  return scene.simulation.solve(few_points);
}

std::vector<gpu::Optical> at(const gpu::Material& material, std::span<const glm::vec3> places) {
  std::vector<gpu::Optical> optical;
  for (const glm::vec3& place : places) optical.push_back(gpu::material_at(material, place, 0));
  return optical;
}

// That of the mesh without a part of it.
double without(const ErrorEstimate& all, const ErrorEstimate& part) {
  return std::sqrt(std::max(0.0, all.whole * all.whole - part.whole * part.whole));
}

}  // namespace

TEST_CASE("points drawn in tets lie in them, and are spread as their volume is") {
  const QuadGraph graph = QuadGraph::parse(box_graph({4}, 6.0f), "box");
  const Level& level = graph.levels()[0];
  const std::vector<glm::vec3> points = points_in_tets(level);
  REQUIRE(points.size() == points_of_a_tet * level.tet_count());
  double share[4] = {};  // mean barycentric coordinates
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const glm::uvec4& tet = level.tets[i % level.tet_count()];
    const glm::dmat3 edges(glm::dvec3(level.vertices[tet[1]] - level.vertices[tet[0]]),
                           glm::dvec3(level.vertices[tet[2]] - level.vertices[tet[0]]),
                           glm::dvec3(level.vertices[tet[3]] - level.vertices[tet[0]]));
    const glm::dvec3 w = glm::inverse(edges) * glm::dvec3(points[i] - level.vertices[tet[0]]);
    const double all[4] = {1 - w.x - w.y - w.z, w.x, w.y, w.z};
    for (int k = 0; k < 4; ++k) {
      CHECK(all[k] > -1e-4);
      share[k] += all[k] / static_cast<double>(points.size());
    }
  }
  // The standard deviation of a coordinate in a tet is sqrt(3 / 80).
  for (const double each : share)
    CHECK(std::abs(each - 0.25) < 5 * std::sqrt(3.0 / 80 / static_cast<double>(points.size())));
}

TEST_CASE("the load is what the one operator's product with the fluence has more than the other's") {
  const QuadGraph graph = QuadGraph::parse(box_graph({3}, 5.0f), "box");
  const Level& level = graph.levels()[0];
  const std::vector<gpu::Optical> here = at(veined(), level.nodes), there = at(checker(2.0f), level.nodes);
  std::vector<glm::vec3> fluence;
  for (const glm::vec3& p : level.vertices) fluence.emplace_back(1 + p.x, 2 + p.y * p.z, 3 + p.z);
  const std::vector<glm::vec3> load = medium_load(level, here, there, fluence);
  const auto product = [&](std::span<const gpu::Optical> optical) {
    const Rows rows = assemble(level, {Method::fem, Source::buried, Model::diffusion, optical, 1.3});
    std::vector<glm::dvec3> result;
    for (std::uint32_t i = 0; i < rows.size(); ++i) {
      glm::dvec3 sum = rows.diagonal[i].a11 * glm::dvec3(fluence[i]);
      for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
        sum += rows.weight[k].a11 * glm::dvec3(fluence[rows.column[k]]);
      }
      result.push_back(sum);
    }
    return result;
  };
  const std::vector<glm::dvec3> one = product(here), other = product(there);
  for (std::size_t i = 0; i < load.size(); ++i) {
    const glm::dvec3 off = glm::abs(glm::dvec3(load[i]) - (one[i] - other[i]));
    CHECK(std::max({off.x, off.y, off.z}) < 1e-5);
  }
}

TEST_CASE("a material that changes within tets is told of, and one that does not is not") {
  Scene scene({8, 4});
  gpu::Material same = checker(3.0f);
  same.second_sigma_s_prime = same.sigma_s_prime;
  same.second_sigma_a = same.sigma_a;
  const SolveReport even = solved(scene, homogeneous(0.02f)), alike = solved(scene, same);
  CHECK(alike.mesh_error->whole == doctest::Approx(even.mesh_error->whole).epsilon(0.02));
  CHECK(alike.mesh_warning.find("within tets") == std::string::npos);
  const SolveReport coarse = solved(scene, checker(3.0f));
  CHECK(coarse.mesh_warning.find("the material changes within tets") != std::string::npos);
  CHECK(coarse.error->whole >= coarse.mesh_error->whole);
  // Cells of 5 mm from 0 on are those of the box of 10 mm: no tet holds a step.
  CHECK(solved(scene, checker(5.0f)).mesh_warning.find("within tets") == std::string::npos);
}

TEST_CASE("arrays are judged by what is given elsewhere, and without that not") {
  Scene scene({8, 4});
  const gpu::Material material = checker(3.0f);
  const auto told = [&](bool elsewhere) {
    for (std::uint32_t i = 0; i < scene.simulation.level_count(); ++i) {
      const Level& level = scene.graph.levels()[i];
      const bool there = elsewhere && i == 0;
      scene.simulation.set_optical(i, at(material, level.nodes), material.eta,
                                   there ? at(material, points_in_tets(level)) : std::vector<gpu::Optical>{});
    }
    scene.light(one_side);
    return *scene.simulation.solve(few_points).mesh_error;
  };
  const ErrorEstimate by_material = *solved(scene, material).mesh_error, known = told(true), unknown = told(false);
  CHECK(known.whole == doctest::Approx(by_material.whole).epsilon(1e-6));
  CHECK(without(known, unknown) > 0.3 * unknown.whole);
}
