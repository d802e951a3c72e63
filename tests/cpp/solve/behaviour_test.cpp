// What a solve does and says: iterations, limits, what is done again, and failures.
#include <doctest/doctest.h>

#include <limits>

#include "engine/base/error.h"
#include "engine/solve/level_solver.h"
#include "tests/cpp/fixtures/one_body.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

using namespace quadgraph;

TEST_CASE("a start from the coarser level saves iterations") {
  Scene alone({6});
  Scene chain({6, 3});
  for (Scene* scene : {&alone, &chain}) {
    scene->simulation.set_material(homogeneous(0.01f));
    scene->light(one_side);
  }
  for (Method method : all_methods) {
    for (SolverKind solver : both_solvers) {
      CAPTURE(name_of(method));
      CAPTURE(name_of(solver));
      const SolveReport from_zero = alone.simulation.solve(options(method, solver, 1e-3));
      const SolveReport from_coarse = chain.simulation.solve(options(method, solver, 1e-3));
      CHECK(from_coarse.levels.back().iterations < from_zero.levels.back().iterations);
      CHECK(!from_zero.error);
      CHECK(from_coarse.error);
    }
  }
}

TEST_CASE("iterations stop at the limit, with the reference's iterate") {
  Scene scene({4});
  scene.simulation.set_material(veined());
  scene.light(one_side);
  const Level& level = scene.graph.levels()[0];
  const auto optical = evaluate_material(level, veined());
  const auto q = scene.irradiance(0, one_side);
  for (Method method : all_methods) {
    for (SolverKind solver : both_solvers) {
      for (const std::uint32_t limit : {1u, 5u, 8u, 35u}) {
        CAPTURE(name_of(method));
        CAPTURE(name_of(solver));
        CAPTURE(limit);
        const SolveOptions how = options(method, solver, 1e-7, limit);
        const SolveReport report = scene.simulation.solve(how);
        CHECK(report.levels[0].iterations == limit);
        CHECK(!report.levels[0].converged);
        CHECK(report.levels[0].residual > 1e-7);
        const ReferenceSolution expected = solve_reference(
            level, optical, 1.3, {{gpu::BEAM_LAMBERTIAN, glm::vec3(0), {}, {}}, q}, how, Entries::stored);
        // The relaxation's step differs: the GPU bounds each channel, the CPU all together.
        const bool same_step = solver == SolverKind::dpcg || method != Method::fem;
        if (same_step) CHECK(relative_difference(scene.simulation.phi(), expected.phi) < 1e-3);
      }
    }
  }
}

TEST_CASE("what single precision cannot reach is said, not looped for") {
  Scene scene({4, 2});
  scene.simulation.set_material(homogeneous(0.001f));
  scene.light(one_side);
  for (Method method : all_methods) {
    for (SolverKind solver : both_solvers) {
      CAPTURE(name_of(method));
      CAPTURE(name_of(solver));
      const SolveReport report = scene.simulation.solve(options(method, solver, 1e-12, 100000));
      CHECK(!report.levels.back().converged);
      CHECK(report.levels.back().residual > 1e-12);
      CHECK(report.levels.back().residual < 1e-5);
      CHECK(report.levels.back().iterations < 20000);
    }
  }
}

TEST_CASE("only what changed is done again, and results repeat bit for bit") {
  Scene scene({4, 2});
  Simulation& simulation = scene.simulation;
  simulation.set_material(homogeneous(0.1f));
  scene.light(one_side);
  for (Method method : all_methods) {
    CAPTURE(name_of(method));
    const SolveOptions how = options(method, SolverKind::dpcg, 1e-4);
    simulation.solve(how);
    CHECK(pass_count(simulation, "assembly") == 2);
    // Linear elements want one value where the material is the same everywhere, the others one for each node.
    CHECK(pass_count(simulation, "material") == (method == Method::quadgraph_fdm ? 0 : 2));
    const std::vector<glm::vec3> first = simulation.phi();

    simulation.solve(how);
    CHECK(pass_count(simulation, "assembly") == 0);
    CHECK(pass_count(simulation, "right-hand side") == 0);
    CHECK(pass_count(simulation, "cg-multiply") > 0);
    CHECK(simulation.phi() == first);

    scene.light([](const glm::vec3& p) { return 2.0f * one_side(p); });
    simulation.solve(how);
    CHECK(pass_count(simulation, "assembly") == 0);
    CHECK(pass_count(simulation, "material") == 0);
    CHECK(pass_count(simulation, "right-hand side") == 3);
    CHECK(pass_count(simulation, "source walk") == 0);
    CHECK(simulation.phi() != first);

    scene.light(one_side);
    simulation.solve(how);
    CHECK(simulation.phi() == first);
  }
  simulation.set_material(homogeneous());
  simulation.solve({});
  CHECK(pass_count(simulation, "material") == 2);
  CHECK(pass_count(simulation, "assembly") == 2);
  CHECK(pass_count(simulation, "source walk") == 2);
  for (const PassStats& pass : simulation.passes()) {
    CAPTURE(pass.name);
    CHECK(pass.time_ms > 0);
    CHECK(pass.bytes > 0);
    CHECK(pass.count > 0);
  }
}

TEST_CASE("input that cannot be used is refused with what is allowed") {
  Scene scene({3});
  Simulation& simulation = scene.simulation;
  CHECK_THROWS_AS(simulation.solve({}), InputError);
  CHECK_THROWS_AS(simulation.eta(), InputError);
  CHECK_THROWS_AS(simulation.phi(), InputError);
  CHECK_THROWS_AS(simulation.surface_field(), InputError);
  gpu::Material bad = homogeneous();
  bad.eta = 5.0f;
  CHECK_THROWS_AS(simulation.set_material(bad), InputError);
  simulation.set_material(homogeneous());
  CHECK_THROWS_AS(simulation.solve(options(Method::fem, SolverKind::dpcg, 0)), InputError);
  std::vector<glm::vec3> q = scene.irradiance(0, one_side);
  CHECK_THROWS_AS(simulation.set_irradiance(1, q), InputError);
  q[3].y = -1.0f;
  CHECK_THROWS_WITH_AS(simulation.set_irradiance(0, q), doctest::Contains("surface node 3, channel 1"), InputError);
  q.pop_back();
  CHECK_THROWS_AS(simulation.set_irradiance(0, q), InputError);
}

TEST_CASE("light that is not finite is a solver error, and the next solve is sound") {
  Scene scene({3});
  scene.simulation.set_material(homogeneous());
  std::vector<glm::vec3> q = scene.irradiance(0, one_side);
  q[0].y = std::numeric_limits<float>::quiet_NaN();
  device::write_bytes(scene.device.context, scene.simulation.level(0).q, std::as_bytes(std::span(q)));
  scene.simulation.irradiance_changed();
  for (SolverKind solver : both_solvers) {
    CHECK_THROWS_WITH_AS(scene.simulation.solve(options(Method::fem, solver, 1e-3)), doctest::Contains("channel 1"),
                         SolverError);
  }
  CHECK_THROWS_AS(scene.simulation.phi(), InputError);
  scene.light(one_side);
  CHECK(scene.simulation.solve({}).levels[0].converged);
}

TEST_CASE("a matrix that is not positive definite breaks down by name") {
  CheckedContext device;
  device::Device& context = device.context;
  const OwnedLevel owned = split_at_centroids(box_level(2, 4.0f));
  const OperatorKey key{Method::fem, Model::diffusion};
  const Level level = owned.view();
  Operators operators;
  operators.create(context, {&level, 1}, key, true, false);
  OperatorBuffers& op = operators.at(key, 0);
  OneBody refractions(context, 1);
  const BodyBoundaries& boundaries = refractions.boundaries(key.method, Source::buried, key.model);
  Workspace work(context, op.count);
  const std::vector<glm::vec3> one(op.entries, glm::vec3(1)), minus(op.entries, glm::vec3(-1));
  std::vector<std::uint32_t> entries = device::download<std::uint32_t>(context, op.entry);
  for (std::size_t e = 0; e < op.entries; ++e) store_weight(entries, e, {glm::dvec3(-1), {}, {}}, op.model, op.stored);
  const auto write = [&](const device::Buffer& buffer, const std::vector<glm::vec3>& values) {
    device::write_bytes(context, buffer, std::as_bytes(std::span(values)).first(buffer.size()));
  };
  const gpu::Scale scale{.scale = glm::vec3(1), .inverse = glm::vec3(1), .unlit = 0};
  device::write_bytes(context, work.scale, std::as_bytes(std::span(&scale, 1)));
  gpu::SolveState state = device::download<gpu::SolveState>(context, op.state)[0];
  state.norm = glm::vec3(static_cast<float>(op.count));
  for (SolverKind solver : both_solvers) {
    write(op.diagonal, one);
    write(op.row_sum, minus);
    device::write_bytes(context, op.entry, std::as_bytes(std::span(entries)));
    write(op.b, one);
    write(op.surface_share, std::vector<glm::vec3>(op.surface_share.size(), glm::vec3(0)));
    write(op.x, std::vector<glm::vec3>(op.entries, glm::vec3(0)));
    write(op.damping, one);
    device::write_bytes(context, op.state, std::as_bytes(std::span(&state, 1)));
    const char* expected = solver == SolverKind::dpcg ? "not positive definite" : "diverges";
    LevelSolver level_solver(work, operators, key, 0,
                             {.solver = solver, .boundaries = boundaries.on_device, .max_iterations = 5000});
    CHECK_THROWS_WITH_AS(level_solver.run(), doctest::Contains(expected), SolverError);
  }
}

// The published surface rows lose definiteness where kappa behind the surface falls below h / (1 + h) of that on it.
TEST_CASE("published rows that are not positive definite fail on the GPU as in the reference") {
  Scene scene({2});
  scene.simulation.set_material(veined());
  scene.light([](const glm::vec3& p) { return glm::vec3(p.x, p.y, 0.5f); });
  const SolveOptions how = options(Method::quadgraph_fdm, SolverKind::dpcg, 1e-6);
  CHECK_THROWS_WITH_AS(scene.simulation.solve(how), doctest::Contains("level 0: quadgraph-fdm"), SolverError);
  const Level& level = scene.graph.levels()[0];
  const auto q = scene.irradiance(0, [](const glm::vec3& p) { return glm::vec3(p.x, p.y, 0.5f); });
  CHECK_THROWS_AS(solve_reference(level, evaluate_material(level, veined()), 1.3,
                                  {{gpu::BEAM_LAMBERTIAN, glm::vec3(0), {}, {}}, q}, how),
                  SolverError);
}
