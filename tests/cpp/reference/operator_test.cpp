// Algebra of the operators: symmetry, definiteness, linear precision, and the published rows.
#include <doctest/doctest.h>

#include <random>

#include "engine/base/error.h"
#include "engine/optics/fresnel.h"
#include "tests/cpp/fixtures/graph_cases.h"

using namespace quadgraph;

namespace {

const Block* block_at(const Rows& rows, std::uint32_t i, std::uint32_t j) {
  for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
    if (rows.column[k] == j) return &rows.weight[k];
  }
  return nullptr;
}

bool equal(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::all(glm::lessThanEqual(glm::abs(a - b), 1e-12 * (glm::abs(a) + glm::abs(b))));
}

Field random_field(std::mt19937& random, Model model) {
  std::normal_distribution<double> normal;
  Field field;
  for (int c = 0; c < 3; ++c) {
    field.phi[c] = normal(random);
    if (model == Model::sp3) field.phi2[c] = normal(random);
  }
  return field;
}

}  // namespace

TEST_CASE("rows are symmetric for every method and model in a heterogeneous material") {
  const OwnedLevel owned = box_level(3, 5.0f, 0.2f);
  const Level level = owned.view();
  const Opticals optical = varying(level, 0.1f);
  for (Method method : all_methods) {
    for (Model model : both_models) {
      const Rows rows = assemble(level, {method, Source::buried, model, optical, 1.3});
      REQUIRE(rows.size() == carrier_count(level, method));
      for (std::uint32_t i = 0; i < rows.size(); ++i) {
        for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
          const Block* back = block_at(rows, rows.column[k], i);
          REQUIRE(back != nullptr);
          CHECK(equal(rows.weight[k].a11, back->a11));
          CHECK(equal(rows.weight[k].a12, back->a12));
          CHECK(equal(rows.weight[k].a22, back->a22));
        }
      }
    }
  }
}

TEST_CASE("fem and fv are positive definite on random probes, at contrasts of 10^4") {
  const OwnedLevel owned = box_level(4, 6.0f, 0.2f);
  const Level level = owned.view();
  std::mt19937 random(3);
  for (const float sigma_a : {0.0f, 0.01f, 10.0f}) {
    const Opticals optical = varying(level, sigma_a, 1e4f);
    for (Method method : {Method::fem, Method::quadgraph_fv}) {
      for (Model model : both_models) {
        const Rows rows = assemble(level, {method, Source::buried, model, optical, 1.3});
        for (int probe = 0; probe < 20; ++probe) {
          std::vector<Field> x;
          for (std::size_t i = 0; i < rows.size(); ++i) x.push_back(random_field(random, model));
          const std::vector<Field> y = quadgraph::apply(rows, x);
          glm::dvec3 energy(0);
          for (std::size_t i = 0; i < x.size(); ++i) energy += dot(x[i], y[i]);
          for (int c = 0; c < 3; ++c) CHECK(energy[c] > 0);
        }
      }
    }
  }
}

TEST_CASE("diffusion is the corner of the SP3 blocks, but for the surface") {
  const OwnedLevel owned = box_level(3, 5.0f, 0.2f);
  const Level level = owned.view();
  const Opticals optical = varying(level, 0.1f);
  const Rows one = assemble(level, {Method::fem, Source::buried, Model::diffusion, optical, 1.0});
  const Rows two = assemble(level, {Method::fem, Source::buried, Model::sp3, optical, 1.0});
  for (std::uint32_t v = level.surface_vertex_count; v < level.vertex_count(); ++v) {
    CHECK(equal(one.diagonal[v].a11, two.diagonal[v].a11));
    for (std::uint32_t k = one.offset[v]; k < one.offset[v + 1]; ++k) {
      CHECK(equal(one.weight[k].a11, two.weight[k].a11));
      CHECK(one.weight[k].a22 == glm::dvec3(0));
    }
  }
}

TEST_CASE("fem: the stiffness of linear functions vanishes at inner vertices") {
  const OwnedLevel owned = box_level(4, 3.0f, 0.25f);
  const Level level = owned.view();
  const Opticals optical = uniform(level, 0.4f, 0.0f);
  for (Model model : both_models) {
    const Rows rows = assemble(level, {Method::fem, Source::buried, model, optical, 1.3});
    std::vector<Field> linear;
    for (const glm::vec3& p : level.vertices) linear.push_back({glm::dvec3(2.0 + 3.0 * p.x - 1.5 * p.y + 0.7 * p.z)});
    const auto y = quadgraph::apply(rows, linear);
    for (std::uint32_t v = level.surface_vertex_count; v < level.vertex_count(); ++v) {
      CHECK(std::abs(y[v].phi.x) < 1e-12 * rows.diagonal[v].a11.x * 20.0);
      CHECK(std::abs(y[v].phi2.x) < 1e-12 * rows.diagonal[v].a11.x * 20.0);
    }
  }
}

TEST_CASE("fdm: rows times the diagonal change of variables are the published Eq. 5 and 6") {
  const OwnedLevel owned = box_level(3, 6.0f, 0.2f);
  const Level level = owned.view();
  const Opticals optical = varying(level, 0.05f);
  const double eta = 1.3;
  const Rows rows = assemble(level, {Method::quadgraph_fdm, Source::diffuse, Model::diffusion, optical, eta});
  std::vector<glm::dvec3> phi;
  std::vector<Field> x;
  for (std::size_t i = 0; i < level.nodes.size(); ++i) {
    phi.emplace_back(1.0 + std::sin(0.7 * static_cast<double>(i)), 2.0, 3.0 + std::cos(static_cast<double>(i)));
    x.push_back({phi[i] / rows.to_phi[i]});
  }
  const auto y = quadgraph::apply(rows, x);
  const auto kappa = [&](std::uint32_t i) { return glm::dvec3(gpu::kappa(optical[i])); };
  const auto distance = [&](std::uint32_t i, std::uint32_t j) {
    return glm::length(glm::dvec3(level.nodes[i]) - glm::dvec3(level.nodes[j]));
  };
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    glm::dvec3 published(0);  // Eq. 5, left side
    double w = 0;
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t j = level.links[t][k];
      const double weight = 1.0 / (distance(t, j) * distance(t, j));
      published += weight * kappa(j) * phi[j];
      w += weight;
    }
    published -= (w * kappa(t) + glm::dvec3(optical[t].sigma_a)) * phi[t];
    for (int c = 0; c < 3; ++c) CHECK(-y[t].phi[c] == doctest::Approx(published[c]).epsilon(1e-9));
  }
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const std::uint32_t s = level.tet_count() + f, k = level.face_tets[f];
    const double a = mismatch(eta), d = distance(s, k);
    const glm::dvec3 published = phi[s] + 2.0 * a * kappa(s) * (phi[s] - phi[k]) / d;  // Eq. 6, left side
    const glm::dvec3 row_factor = kappa(k) / (2.0 * a * kappa(s) * d);
    for (int c = 0; c < 3; ++c) CHECK(y[s].phi[c] == doctest::Approx((row_factor * published)[c]).epsilon(1e-9));
  }
}

TEST_CASE("a reflecting face carries no boundary term and takes no light") {
  OwnedLevel owned = box_level(2, 2.0f);
  owned.face_kinds.assign(owned.faces.size(), face_reflecting);
  const Level level = owned.view();
  const Opticals optical = uniform(level, 0.3f, 0.0f);
  const auto q = everywhere(level, glm::vec3(1));
  for (Method method : all_methods) {
    const Problem problem{method, Source::diffuse, Model::sp3, optical, 1.3};
    const Rows rows = assemble(level, problem);
    std::vector<Field> constant;
    for (const glm::dvec3& to_phi : rows.to_phi) constant.push_back({1.0 / to_phi});
    for (const Field& y : quadgraph::apply(rows, constant)) CHECK(std::abs(y.phi.x) < 1e-12);
    for (const Field& b : diffuse_load(level, problem, q)) CHECK(b.phi == glm::dvec3(0));
  }
}

TEST_CASE("coefficients out of range are refused by name") {
  const OwnedLevel owned = box_level(1, 1.0f);
  const Level level = owned.view();
  Opticals optical = uniform(level, 1.0f, 0.1f);
  const auto with = [&](double eta, Model model) { return Problem{Method::fem, Source::buried, model, optical, eta}; };
  CHECK_THROWS_WITH_AS(assemble(level, with(0.5, Model::sp3)), doctest::Contains("eta"), InputError);
  CHECK_THROWS_WITH_AS(assemble(level, with(1.3, Model::automatic)), doctest::Contains("auto"), InputError);
  optical[3].sigma_s_prime.y = -1;
  CHECK_THROWS_WITH_AS(assemble(level, with(1.3, Model::sp3)), doctest::Contains("optical[3]"), InputError);
  optical.pop_back();
  CHECK_THROWS_AS(assemble(level, with(1.3, Model::sp3)), InputError);
}
