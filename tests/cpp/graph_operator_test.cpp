// Physics of the two operators and the CPU reference.
#include <doctest/doctest.h>

#include <cmath>

#include "engine/graph/error.h"
#include "engine/graph/fresnel.h"
#include "engine/graph/reference.h"
#include "shaders/optics.h"
#include "tests/cpp/test_levels.h"

using namespace quadgraph;

namespace {

// The coefficients with diffusion coefficient kappa, mm, as far as sigma_a leaves room.
gpu::Optical optical_at(const glm::vec3& kappa, const glm::vec3& sigma_a) {
  return {glm::max(1.0f / (3.0f * kappa) - sigma_a, glm::vec3(0)), sigma_a};
}

std::vector<gpu::Optical> uniform(const Level& level, float kappa, float sigma_a) {
  return std::vector<gpu::Optical>(level.nodes.size(), optical_at(glm::vec3(kappa), glm::vec3(sigma_a)));
}

// kappa varies by a factor of `contrast` across the body.
std::vector<gpu::Optical> varying(const Level& level, float sigma_a, float contrast = 10.0f) {
  std::vector<gpu::Optical> optical;
  for (const glm::vec3& p : level.nodes) {
    const float wave = std::pow(contrast, 0.5f * std::sin(1.3f * p.x + 0.7f * p.y - p.z));
    optical.push_back(optical_at(wave * glm::vec3(0.2f, 0.3f, 0.5f), sigma_a * glm::vec3(1.0f, 2.0f, 0.5f) / wave));
  }
  return optical;
}

// Lit on the side x = 0 only.
std::vector<glm::vec3> one_side(const Level& level) {
  std::vector<glm::vec3> q;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    q.push_back(level.nodes[level.tet_count() + f].x < 1e-4f ? glm::vec3(1.0f, 0.8f, 0.6f) : glm::vec3(0));
  }
  return q;
}

double weight_at(const Rows& rows, std::uint32_t i, std::uint32_t j, int c) {
  for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
    if (rows.column[k] == j) return rows.weight[k][c];
  }
  return 0;
}

constexpr std::array<Method, 3> all_methods = {Method::fem, Method::quadgraph_fv, Method::quadgraph_fdm};

}  // namespace

TEST_CASE("rows are symmetric for both methods in a heterogeneous material") {
  const OwnedLevel owned = box_level(3, 5.0f, 0.2f);
  const Level level = owned.view();
  for (Method method : all_methods) {
    const Rows rows = assemble(level, method, varying(level, 0.1f), 1.3);
    REQUIRE(rows.size() == unknown_count(level, method));
    for (std::uint32_t i = 0; i < rows.size(); ++i) {
      for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
        for (int c = 0; c < 3; ++c) {
          const double back = weight_at(rows, rows.column[k], i, c);
          CHECK(rows.weight[k][c] == doctest::Approx(back).epsilon(1e-12));
        }
      }
    }
  }
}

TEST_CASE("fem: the stiffness of a linear function vanishes at inner vertices") {
  const OwnedLevel owned = box_level(4, 3.0f, 0.25f);
  const Level level = owned.view();
  const Rows rows = assemble(level, Method::fem, uniform(level, 0.4f, 0.0f), 1.3);
  std::vector<glm::dvec3> linear;
  for (const glm::vec3& p : level.vertices) linear.emplace_back(2.0 + 3.0 * p.x - 1.5 * p.y + 0.7 * p.z);
  const auto y = quadgraph::apply(rows, linear);
  for (std::uint32_t v = level.surface_vertex_count; v < level.vertex_count(); ++v) {
    CHECK(std::abs(y[v].x) < 1e-12 * rows.diagonal[v].x * 20.0);
  }
}

TEST_CASE("fdm: rows times the diagonal change of variables are the published Eq. 5 and 6") {
  const OwnedLevel owned = box_level(3, 6.0f, 0.2f);
  const Level level = owned.view();
  const auto optical = varying(level, 0.05f);
  const double eta = 1.3;
  const Rows rows = assemble(level, Method::quadgraph_fdm, optical, eta);
  std::vector<glm::dvec3> phi, x;
  for (std::size_t i = 0; i < level.nodes.size(); ++i) {
    phi.emplace_back(1.0 + std::sin(0.7 * static_cast<double>(i)), 2.0, 3.0 + std::cos(static_cast<double>(i)));
    x.push_back(phi[i] / rows.to_phi[i]);
  }
  const auto y = quadgraph::apply(rows, x);
  const auto distance = [&](std::uint32_t i, std::uint32_t j) {
    return glm::length(glm::dvec3(level.nodes[i]) - glm::dvec3(level.nodes[j]));
  };
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    glm::dvec3 published(0);  // Eq. 5, left side
    double w = 0;
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t j = level.links[t][k];
      const double weight = 1.0 / (distance(t, j) * distance(t, j));
      published += weight * glm::dvec3(gpu::kappa(optical[j])) * phi[j];
      w += weight;
    }
    published -= (w * glm::dvec3(gpu::kappa(optical[t])) + glm::dvec3(optical[t].sigma_a)) * phi[t];
    for (int c = 0; c < 3; ++c) CHECK(-y[t][c] == doctest::Approx(published[c]).epsilon(1e-9));
  }
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const std::uint32_t s = level.tet_count() + f, k = level.face_tets[f];
    const glm::dvec3 kappa_s(gpu::kappa(optical[s])), kappa_k(gpu::kappa(optical[k]));
    const double a = mismatch(eta), d = distance(s, k);
    const glm::dvec3 published = phi[s] + 2.0 * a * kappa_s * (phi[s] - phi[k]) / d;  // Eq. 6, left side
    const glm::dvec3 row_factor = kappa_k / (2.0 * a * kappa_s * d);
    for (int c = 0; c < 3; ++c) CHECK(y[s][c] == doctest::Approx((row_factor * published)[c]).epsilon(1e-9));
  }
}

TEST_CASE("furnace: uniform light without absorption gives phi = 4q/(1-F_dr) and M = q") {
  const OwnedLevel owned = box_level(4, 5.0f, 0.2f);
  const Level level = owned.view();
  const std::vector<glm::vec3> q(level.faces.size(), glm::vec3(1.5f, 1.0f, 0.25f));
  for (double eta : {1.0, 1.3, 1.5}) {
    const double source = 4.0 / (1.0 - internal_diffuse_reflectance(eta));
    for (Method method : all_methods) {
      // The published scheme holds it for constant kappa only: Eq. 5 differences kappa*phi.
      const auto optical = method == Method::quadgraph_fdm ? uniform(level, 0.3f, 0.0f) : varying(level, 0.0f);
      SolveOptions options;
      options.method = method;
      options.tolerance = 1e-13;
      const auto solution = solve_reference(level, optical, eta, q, options);
      REQUIRE(solution.report.converged);
      for (std::uint32_t f = 0; f < level.face_count(); ++f) {
        for (int c = 0; c < 3; ++c) {
          CHECK(solution.phi_face[f][c] == doctest::Approx(source * q[f][c]).epsilon(1e-10));
          CHECK(solution.exitance[f][c] == doctest::Approx(q[f][c]).epsilon(1e-10));
        }
      }
    }
  }
}

TEST_CASE("furnace: the published differences miss it where kappa varies") {
  const OwnedLevel owned = box_level(4, 5.0f, 0.2f);
  const Level level = owned.view();
  const std::vector<glm::vec3> q(level.faces.size(), glm::vec3(1.0f));
  SolveOptions options;
  options.method = Method::quadgraph_fdm;
  options.tolerance = 1e-12;
  const auto solution = solve_reference(level, varying(level, 0.0f, 1.5f), 1.3, q, options);
  double worst = 0;
  for (const glm::dvec3& m : solution.exitance) worst = std::max(worst, std::abs(m.x - 1.0));
  MESSAGE("published differences in the furnace, kappa varying: exitance off by up to " << 100 * worst << "%");
  CHECK(worst > 0.05);
}

TEST_CASE("furnace: what the published differences miss is Q times their Laplacian of kappa") {
  const OwnedLevel owned = box_level(4, 5.0f, 0.2f);
  const Level level = owned.view();
  const auto optical = varying(level, 0.0f, 1.5f);
  const std::vector<glm::vec3> q(level.faces.size(), glm::vec3(1.0f));
  const Rows rows = assemble(level, Method::quadgraph_fdm, optical, 1.3);
  const auto b = right_hand_side(level, Method::quadgraph_fdm, optical, 1.3, q);
  const double source = 4.0 / (1.0 - internal_diffuse_reflectance(1.3));
  std::vector<glm::dvec3> x;
  for (const glm::dvec3& to_phi : rows.to_phi) x.push_back(source / to_phi);
  const auto y = quadgraph::apply(rows, x);
  double largest = 0;
  for (std::uint32_t i = 0; i < rows.size(); ++i) {
    glm::dvec3 laplacian(0);  // of kappa, by the weights of Eq. 5; the surface rows (Eq. 6) hold exactly
    for (std::uint32_t k = rows.offset[i]; i < level.tet_count() && k < rows.offset[i + 1]; ++k) {
      laplacian -=
          rows.weight[k] * (glm::dvec3(gpu::kappa(optical[rows.column[k]])) - glm::dvec3(gpu::kappa(optical[i])));
    }
    const glm::dvec3 missed = y[i] - b[i] + source * laplacian;
    for (int c = 0; c < 3; ++c) CHECK(std::abs(missed[c]) <= 1e-12 * std::abs(rows.diagonal[i][c] * x[i][c]));
    largest = std::max(largest, std::abs(laplacian.x));
  }
  CHECK(largest > 0.01);
}

TEST_CASE("fem and fv: what enters leaves or is absorbed") {
  const OwnedLevel owned = box_level(5, 8.0f, 0.2f);
  const Level level = owned.view();
  for (Method method : {Method::fem, Method::quadgraph_fv}) {
    SolveOptions options;
    options.method = method;
    options.tolerance = 1e-12;
    const auto solution = solve_reference(level, varying(level, 0.02f), 1.3, one_side(level), options);
    for (int c = 0; c < 3; ++c) {
      CHECK(std::abs(solution.energy.balance()[c]) < 1e-10);
      CHECK(solution.energy.absorbed[c] > 0.01 * solution.energy.entered[c]);
    }
  }
}

TEST_CASE("fv: phi is never negative, however strong the absorption") {
  const OwnedLevel owned = box_level(5, 8.0f, 0.2f);
  const Level level = owned.view();
  SolveOptions options;
  options.method = Method::quadgraph_fv;
  options.tolerance = 1e-12;
  const auto solution = solve_reference(level, varying(level, 2.0f), 1.3, one_side(level), options);
  for (const glm::dvec3& phi : solution.phi) CHECK(std::min({phi.x, phi.y, phi.z}) >= 0);  // an M-matrix
}

TEST_CASE("relaxation and conjugate gradients reach the same solution") {
  const OwnedLevel owned = box_level(4, 4.0f, 0.15f);
  const Level level = owned.view();
  for (Method method : all_methods) {
    SolveOptions options;
    options.method = method;
    options.tolerance = 1e-9;
    const auto optical = varying(level, 0.05f, method == Method::quadgraph_fdm ? 1.5f : 10.0f);
    const auto cg = solve_reference(level, optical, 1.3, one_side(level), options);
    options.solver = SolverKind::cascade;
    options.max_iterations = 100000;
    const auto relaxed = solve_reference(level, optical, 1.3, one_side(level), options);
    REQUIRE(cg.report.converged);
    REQUIRE(relaxed.report.converged);
    CHECK(cg.report.iterations < relaxed.report.iterations);
    for (std::size_t i = 0; i < cg.phi.size(); ++i) {
      for (int c = 0; c < 3; ++c) CHECK(relaxed.phi[i][c] == doctest::Approx(cg.phi[i][c]).epsilon(1e-5));
    }
  }
}

TEST_CASE("fdm: strong contrast makes the published scheme indefinite, which is said and not hidden") {
  const OwnedLevel owned = box_level(4, 5.0f, 0.2f);
  const Level level = owned.view();
  SolveOptions options;
  options.method = Method::quadgraph_fdm;
  options.tolerance = 1e-12;
  CHECK_THROWS_AS(solve_reference(level, varying(level, 0.0f, 10.0f), 1.3, one_side(level), options), SolverError);
}

TEST_CASE("numbers that are lost are a solver error, not a converged answer") {
  OwnedLevel owned = box_level(2, 1.0f);
  owned.nodes[owned.tets.size()] = owned.nodes[owned.face_tets[0]];  // a link without length
  const Level level = owned.view();
  for (const SolverKind solver : {SolverKind::dpcg, SolverKind::cascade}) {
    SolveOptions options;
    options.method = Method::quadgraph_fdm;
    options.solver = solver;
    const std::vector<glm::vec3> q(level.faces.size(), glm::vec3(1.0f));
    CHECK_THROWS_WITH_AS(solve_reference(level, uniform(level, 1.0f, 0.1f), 1.3, q, options),
                         doctest::Contains("not finite"), SolverError);
  }
}

TEST_CASE("no light, no answer but zero") {
  const OwnedLevel owned = box_level(2, 1.0f);
  const Level level = owned.view();
  const std::vector<glm::vec3> q(level.faces.size(), glm::vec3(0));
  const auto solution = solve_reference(level, uniform(level, 1.0f, 0.1f), 1.3, q, {});
  CHECK(solution.report.converged);
  for (const glm::dvec3& m : solution.exitance) CHECK(m == glm::dvec3(0));
}

TEST_CASE("coefficients out of range are refused by name") {
  const OwnedLevel owned = box_level(1, 1.0f);
  const Level level = owned.view();
  auto optical = uniform(level, 1.0f, 0.1f);
  CHECK_THROWS_WITH_AS(assemble(level, Method::fem, optical, 0.5), doctest::Contains("eta"), InputError);
  optical[3].sigma_s_prime.y = -1;
  CHECK_THROWS_WITH_AS(assemble(level, Method::fem, optical, 1.3), doctest::Contains("optical[3]"), InputError);
  optical.pop_back();
  CHECK_THROWS_AS(assemble(level, Method::fem, optical, 1.3), InputError);
}

TEST_CASE("Fresnel: energy, limits and the published polynomial") {
  CHECK(fresnel_transmittance(0.7, 1.0) == doctest::Approx(1.0));
  CHECK(fresnel_transmittance(1.0, 1.5) == doctest::Approx(0.96));
  CHECK(fresnel_transmittance(0.0, 1.3) == doctest::Approx(0.0));
  CHECK(internal_diffuse_reflectance(1.0) == 0.0);
  CHECK(mismatch(1.3) == doctest::Approx(2.602).epsilon(1e-3));
}
