// Solutions of the GPU: against the CPU reference, closed forms and conservation.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtx/component_wise.hpp>

#include "engine/base/error.h"
#include "engine/optics/boundary.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

using namespace quadgraph;

namespace {

ReferenceSolution reference(const Scene& scene, const gpu::Material& material, const std::vector<glm::vec3>& q,
                            const SolveOptions& how, const glm::vec3& direction) {
  const Level& level = scene.graph.levels()[0];
  return solve_reference(level, evaluate_material(level, material), material.eta,
                         {{gpu::BEAM_DIRECTIONAL, glm::normalize(direction), {}, {}}, q}, how, Entries::stored);
}

// phi at the carriers on the surface: vertices, or surface nodes.
std::vector<glm::dvec3> phi_from_coarse(const Scene& scene, Method method, const std::vector<glm::dvec3>& coarse) {
  const Level& level = scene.graph.levels()[0];
  const Transfer& t = method == Method::fem ? level.barycentric : level.surface;
  const std::uint32_t first = method == Method::fem ? 0 : scene.graph.levels()[1].tet_count();
  std::vector<glm::dvec3> phi(method == Method::fem ? level.surface_vertex_count : level.face_count(), glm::dvec3(0));
  for (std::size_t i = 0; i < phi.size() * t.width; ++i) {
    phi[i / t.width] += static_cast<double>(t.weight[i]) * coarse[first + t.index[i]];
  }
  return phi;
}

// Area and q of a carrier on the surface.
struct Share {
  double area = 0, unlit = 0;
  glm::dvec3 q{0};  // times the area
};

std::vector<Share> shares_of(const Level& level, Method method, const SurfaceField& field) {
  double power = 0, area = 0;
  for (std::size_t f = 0; f < field.q.size(); ++f) {
    area += static_cast<double>(field.area[f]);
    power += static_cast<double>(field.area[f]) * glm::compAdd(glm::dvec3(field.q[f]));
  }
  std::vector<Share> shares(method == Method::fem ? level.surface_vertex_count : level.face_count());
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::dvec3 q(field.q[f]);
    const bool unlit = glm::compAdd(q) < 0.1 * power / area;
    const auto add = [&](Share& share, double size) {
      share.area += size;
      share.unlit += unlit ? size : 0;
      share.q += size * q;
    };
    const auto size = static_cast<double>(field.area[f]);
    if (method != Method::fem) add(shares[f], size);
    for (int k = 0; k < 3 && method == Method::fem; ++k) add(shares[level.faces[f][k]], size / 3);
  }
  return shares;
}

}  // namespace

TEST_CASE("the error estimate compares the exitance with that of the coarser level's solution") {
  Scene scene({6, 3});
  scene.simulation.set_material(homogeneous());
  scene.light(one_side);
  const Level& fine = scene.graph.levels()[0];
  const Level& coarse = scene.graph.levels()[1];
  const auto coarse_q = scene.irradiance(1, one_side);
  for (Method method : all_methods) {
    const SolveOptions how = options(method, SolverKind::dpcg, 1e-6);
    const Boundary boundary = boundary_of(method, Source::diffuse, Model::diffusion, 1.3);
    const SolveReport report = scene.simulation.solve(how);
    const std::vector<Share> shares = shares_of(fine, method, scene.simulation.surface_field());
    const std::vector<glm::vec3> phi = scene.simulation.phi();
    const auto optical = evaluate_material(coarse, homogeneous());
    const std::vector<glm::dvec3> start =
        phi_from_coarse(scene, method,
                        solve_reference(coarse, optical, 1.3f, {{gpu::BEAM_LAMBERTIAN, glm::vec3(0), {}, {}}, coarse_q},
                                        how, Entries::stored)
                            .phi);
    glm::dvec2 difference{0}, norm{0};
    for (std::size_t i = 0; i < start.size(); ++i) {
      const glm::dvec3 value(phi[method == Method::fem ? i : fine.tet_count() + i]);
      const glm::dvec3 m = boundary.k11 * value - boundary.reflected / shares[i].area * shares[i].q;
      const glm::dvec3 d = boundary.k11 * (value - start[i]);
      const glm::dvec2 weight(shares[i].area, shares[i].unlit);
      difference += glm::dot(d, d) * weight;
      norm += glm::dot(m, m) * weight;
    }
    REQUIRE(report.error);
    REQUIRE(report.algebraic);
    CHECK(report.error->whole == doctest::Approx(std::sqrt(difference.x / norm.x) / std::sqrt(3)).epsilon(1e-3));
    CHECK(report.error->unlit == doctest::Approx(std::sqrt(difference.y / norm.y) / std::sqrt(3)).epsilon(1e-3));
    CHECK(report.algebraic->whole < 1e-6);
  }
}

TEST_CASE("the solution equals the CPU reference for every method, model, source and solver") {
  Scene scene({6, 3});
  scene.simulation.set_material(veined());
  const glm::vec3 slanted(1.0f, 0.4f, -0.2f);
  for (std::uint32_t i = 0; i < 2; ++i) scene.simulation.set_irradiance(i, scene.irradiance(i, one_side), slanted);
  const std::vector<glm::vec3> q = scene.irradiance(0, one_side);
  for (const Case& what : all_cases()) {
    CAPTURE(what);
    const ReferenceSolution expected = reference(scene, veined(), q, what.options(SolverKind::dpcg, 1e-10), slanted);
    for (SolverKind solver : both_solvers) {
      CAPTURE(name_of(solver));
      // What a slow rate makes of the last bits of single precision is the least that a relaxation can promise.
      const SolveReport report = scene.simulation.solve(what.options(solver, solver == SolverKind::dpcg ? 1e-5 : 1e-4));
      CHECK(report.source == what.source);
      CHECK(report.model == what.model);
      REQUIRE(report.levels.size() == 2);
      for (const LevelReport& level : report.levels) {
        CHECK(level.converged);
        CHECK(level.residual < 1e-3);
        CHECK(level.iterations > 0);
      }
      CHECK(report.levels[1].level == 0);
      CHECK(report.levels[1].unknowns == expected.report.unknowns);
      // The tolerance is that of the exitance; deep inside phi may be further off.
      CHECK(relative_difference(scene.simulation.phi(), expected.phi) < 2e-4);
      const SurfaceField field = scene.simulation.surface_field();
      CHECK(relative_difference(field.phi, expected.phi_face) < 2e-4);
      CHECK(relative_difference(field.exitance, expected.exitance) < 2e-4);
      CHECK(field.q == q);
      for (int c = 0; c < 3; ++c) {
        CHECK(report.energy.entered[c] == doctest::Approx(expected.energy.entered[c]).epsilon(1e-5));
        CHECK(report.energy.scattered_out[c] == doctest::Approx(expected.energy.scattered_out[c]).epsilon(1e-3));
        CHECK(report.energy.absorbed[c] == doctest::Approx(expected.energy.absorbed[c]).epsilon(1e-3));
        CHECK(report.energy.unscattered_out[c] == doctest::Approx(expected.energy.unscattered_out[c]).epsilon(1e-5));
        CHECK(report.clipped[c] == doctest::Approx(expected.clipped[c]).epsilon(1e-2));
        // A relaxation stops with smooth errors, which the balance sees and the residual hardly does.
        const double balance = solver == SolverKind::dpcg ? 5e-5 : 5e-4;
        if (what.method != Method::quadgraph_fdm) CHECK(std::abs(report.energy.balance()[c]) < balance);
      }
    }
  }
}

TEST_CASE("changing method, model and source back and forth gives the first answer again") {
  Scene scene({4, 2});
  scene.simulation.set_material(homogeneous());
  scene.light(one_side);
  std::vector<std::vector<glm::vec3>> first;
  for (const Case& what : all_cases()) {
    scene.simulation.solve(what.options(SolverKind::dpcg, 1e-4));
    first.push_back(scene.simulation.surface_field().exitance);
  }
  std::size_t k = 0;
  for (const Case& what : all_cases()) {
    CAPTURE(what);
    scene.simulation.solve(what.options(SolverKind::dpcg, 1e-4));
    CHECK(scene.simulation.surface_field().exitance == first[k++]);
  }
}

TEST_CASE("the balance closes in single precision to 1e-5, however fine the mesh, and the exitance is never negative") {
  for (const float size : {0.5f, 50.0f}) {
    Scene scene({6, 3}, size);
    scene.simulation.set_material(veined());
    scene.light(one_side);
    for (Method method : {Method::fem, Method::quadgraph_fv}) {
      for (Model model : {Model::diffusion, Model::sp3}) {
        CAPTURE(size);
        const Case what{method, model, Source::buried};
        CAPTURE(what);
        const SolveReport report = scene.simulation.solve(what.options(SolverKind::dpcg, 1e-6));
        for (int c = 0; c < 3; ++c) CHECK(std::abs(report.energy.balance()[c]) < 1e-5);
        for (const glm::vec3& m : scene.simulation.surface_field().exitance) CHECK(std::min({m.x, m.y, m.z}) >= 0);
        for (const glm::vec3& m :
             device::download<glm::vec3>(scene.device.context, scene.simulation.vertex_exitance())) {
          CHECK(std::min({m.x, m.y, m.z}) >= 0);
        }
      }
    }
  }
}

TEST_CASE("coefficients per node are those of the material they are taken from") {
  Scene scene({4, 2});
  scene.light(one_side);
  scene.simulation.set_material(veined());
  const SolveReport report = scene.simulation.solve({});
  CHECK(report.model == Model::sp3);  // the veins are too dark for diffusion
  const std::vector<glm::vec3> expected = scene.simulation.surface_field().exitance;
  for (std::uint32_t i = 0; i < 2; ++i) {
    const auto optical = evaluate_material(scene.graph.levels()[i], veined());
    scene.simulation.set_optical(i, optical, veined().eta);
    if (i == 0) CHECK_THROWS_WITH_AS(scene.simulation.solve({}), doctest::Contains("level 1"), InputError);
  }
  CHECK(scene.simulation.solve({}).model == Model::sp3);
  CHECK(relative_difference(scene.simulation.surface_field().exitance, expected) < 1e-4);
  const std::vector<gpu::Optical> short_by_one(scene.graph.levels()[0].node_count() - 1, {glm::vec3(1), glm::vec3(0)});
  CHECK_THROWS_WITH_AS(scene.simulation.set_optical(0, short_by_one, 1.3f), doctest::Contains("optical"), InputError);
}

TEST_CASE("a furnace with the diffuse source is uniform to rounding, in both models") {
  Scene scene({6, 3});
  scene.light([](const glm::vec3&) { return glm::vec3(0.1f, 1.0f, 3.0f); });
  for (const Case& what : all_cases()) {
    if (what.source == Source::buried) continue;
    CAPTURE(what);
    // The published differences keep constants of kappa * phi, not of phi: it alone is wrong where kappa varies.
    gpu::Material material = what.method == Method::quadgraph_fdm ? homogeneous() : veined();
    material.sigma_a = material.second_sigma_a = glm::vec3(0);
    scene.simulation.set_material(material);
    const SolveReport report = scene.simulation.solve(what.options(SolverKind::dpcg, 3e-7));
    const Boundary boundary = boundary_of(what.method, what.source, what.model, 1.3);
    for (const glm::vec3& phi : scene.simulation.phi()) {
      CHECK(phi.x == doctest::Approx(0.1 * boundary.source).epsilon(1e-5));
      CHECK(phi.z == doctest::Approx(3.0 * boundary.source).epsilon(1e-5));
    }
    // M is a difference: its error is that of phi, so many times larger.
    const double tolerance = 1e-5 * (1 + 2 * boundary.reflected);
    for (const glm::vec3& m : scene.simulation.surface_field().exitance) {
      CHECK(m.y == doctest::Approx(1.0).epsilon(tolerance));
    }
    const auto vertex_exitance = device::download<glm::vec3>(scene.device.context, scene.simulation.vertex_exitance());
    REQUIRE(vertex_exitance.size() == scene.graph.levels()[0].surface_vertex_count);
    for (const glm::vec3& m : vertex_exitance) CHECK(m.y == doctest::Approx(1.0).epsilon(1e-4));
    for (int c = 0; c < 3; ++c) {
      CHECK(report.energy.absorbed[c] == 0);
      CHECK(std::abs(report.energy.balance()[c]) < 1e-4);
    }
  }
}

TEST_CASE("no light gives exactly zero, in one channel or in all") {
  Scene scene({3, 2});
  scene.simulation.set_material(homogeneous());
  for (Method method : all_methods) {
    for (SolverKind solver : both_solvers) {
      CAPTURE(name_of(method));
      CAPTURE(name_of(solver));
      scene.light([](const glm::vec3& p) { return one_side(p) * glm::vec3(1, 0, 1); });
      SolveReport report = scene.simulation.solve(options(method, solver, 1e-4));
      CHECK(report.levels.back().converged);
      for (const glm::vec3& phi : scene.simulation.phi()) {
        CHECK(phi.x != 0);
        CHECK(phi.y == 0);
      }
      CHECK(report.energy.balance()[1] == 0);

      scene.light([](const glm::vec3&) { return glm::vec3(0); });
      report = scene.simulation.solve(options(method, solver, 1e-4));
      for (const LevelReport& level : report.levels) {
        CHECK(level.converged);
        CHECK(level.iterations == 0);
        CHECK(level.residual == 0);
      }
      for (const glm::vec3& phi : scene.simulation.phi()) CHECK(phi == glm::vec3(0));
      REQUIRE(report.error);
      CHECK(report.error->whole == 0);
    }
  }
}

TEST_CASE("the solution scales with the light, bit for bit, far beyond the range of squares") {
  Scene scene({3, 2});
  scene.simulation.set_material(veined());
  scene.light(one_side);
  scene.simulation.solve({});
  const std::vector<glm::vec3> phi = scene.simulation.phi();
  for (const float factor : {std::exp2(-90.0f), std::exp2(90.0f)}) {
    scene.light([&](const glm::vec3& p) { return factor * one_side(p); });
    CHECK(scene.simulation.solve({}).levels.back().converged);
    const std::vector<glm::vec3> scaled = scene.simulation.phi();
    for (std::size_t i = 0; i < phi.size(); ++i) CHECK(scaled[i] == factor * phi[i]);
  }
}

TEST_CASE("exitance at vertices interpolates to the power of the faces") {
  Scene scene({3, 2});
  scene.simulation.set_material(homogeneous());
  scene.light([](const glm::vec3& p) { return glm::vec3(p.x, p.y, 0.5f); });
  const Level& level = scene.graph.levels()[0];
  for (const Case& what : all_cases()) {
    CAPTURE(what);
    scene.simulation.solve(what.options(SolverKind::dpcg, 1e-4));
    const SurfaceField field = scene.simulation.surface_field();
    const auto at_vertices = device::download<glm::vec3>(scene.device.context, scene.simulation.vertex_exitance());
    const auto unscattered = device::download<glm::vec3>(scene.device.context, scene.simulation.vertex_unscattered());
    glm::dvec3 of_vertices{0}, of_faces{0};
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      const double area = field.area[f];
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t v = level.faces[f][k];
        of_vertices += area / 3 * (glm::dvec3(at_vertices[v]) + glm::dvec3(unscattered[v]));
      }
      of_faces += area * (glm::dvec3(field.exitance[f]) + glm::dvec3(field.unscattered[f]));
    }
    for (int c = 0; c < 3; ++c) CHECK(of_vertices[c] == doctest::Approx(of_faces[c]).epsilon(1e-5));
  }
}
