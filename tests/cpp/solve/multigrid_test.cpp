// The V-cycle as an operator, and solves with it: against the reference, from frame to frame, and where it fails.
#include "engine/solve/multigrid.h"

#include <doctest/doctest.h>

#include <random>

#include "engine/base/error.h"
#include "engine/solve/assembly.h"
#include "engine/solve/mesh_error.h"
#include "tests/cpp/fixtures/one_body.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

using namespace quadgraph;

namespace {

constexpr std::array<SolverKind, 2> with_cycles = {SolverKind::fmg_pcg, SolverKind::vcycle};

// Fields of every carrier as plain numbers, three for each moment.
std::vector<glm::vec3> random_fields(std::size_t count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<glm::vec3> values(count);
  for (glm::vec3& value : values) value = {uniform(generator), uniform(generator), uniform(generator)};
  return values;
}

glm::dvec3 inner_product(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  glm::dvec3 sum{0};
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dvec3(a[i]) * glm::dvec3(b[i]);
  return sum;
}

// The operators of a chain of boxes, assembled, with the bound of their eigenvalues.
struct Chain {
  CheckedContext device;
  QuadGraph graph;
  Simulation simulation;  // fills the coefficients
  Operators operators;
  Workspace work;
  OperatorKey key;
  OneBody refractions{device.context, 1.3f};

  Chain(const std::vector<std::uint32_t>& cells, Model model)
      : graph(QuadGraph::parse(box_graph(cells, 10.0f), "box")),
        simulation(device.context, graph),
        work(device.context, graph.levels()[0].node_count()),
        key{Method::fem, model} {
    simulation.set_material(veined());
    for (std::uint32_t i = 0; i < cells.size(); ++i) {
      const std::vector<glm::vec3> dark(graph.levels()[i].face_count(), glm::vec3(0));
      simulation.set_irradiance(i, dark);
    }
    simulation.solve({.model = model});
    operators.create(device.context, graph.levels(), key, false, true);
    for (std::uint32_t i = 0; i < cells.size(); ++i) {
      record_assembly(work, simulation.level(i), Method::fem,
                      refractions.boundaries(Method::fem, Source::buried, model), false, operators.at(key, i));
      record_damping(work, Method::fem, operators.at(key, i));
      record_majorant(work, operators.at(key, i));
    }
    work.recorder.submit();
  }

  // z = B r.
  std::vector<glm::vec3> cycle(const std::vector<glm::vec3>& r, std::uint32_t smoothing) {
    OperatorBuffers& op = operators.at(key, 0);
    auto state = device::download<gpu::SolveState>(device.context, op.state)[0];
    for (std::uint32_t l = 0; l < MAX_LEVELS; ++l) state.gate[l] = {state.groups[l], 1, 1};
    state.coarse = {1, 1, 1};
    device::write_bytes(device.context, op.state, std::as_bytes(std::span(&state, 1)));
    device::write_bytes(device.context, op.r, std::as_bytes(std::span(r)));
    Multigrid multigrid(work, operators, key, smoothing);
    multigrid.record(0);
    work.recorder.submit();
    return device::download<glm::vec3>(device.context, multigrid.correction(0));
  }
};

}  // namespace

TEST_CASE("a V-cycle is linear, symmetric and positive") {
  for (Model model : {Model::diffusion, Model::sp3}) {
    Chain chain({8, 4, 2}, model);
    const std::size_t count = chain.operators.at(chain.key, 0).r.size() / sizeof(glm::vec3);
    for (std::uint32_t smoothing : {1u, 2u}) {
      CAPTURE(name_of(model));
      CAPTURE(smoothing);
      const auto u = random_fields(count, 1), v = random_fields(count, 2);
      const auto bu = chain.cycle(u, smoothing), bv = chain.cycle(v, smoothing);
      const glm::dvec3 ubv = inner_product(u, bv), vbu = inner_product(v, bu);
      const glm::dvec3 ubu = inner_product(u, bu), vbv = inner_product(v, bv);
      std::vector<glm::vec3> sum(count);
      for (std::size_t i = 0; i < count; ++i) sum[i] = u[i] + v[i];
      const auto b_sum = chain.cycle(sum, smoothing);
      for (std::size_t i = 0; i < count; ++i) sum[i] = bu[i] + bv[i];
      CHECK(relative_difference(b_sum, sum) < 1e-5);
      for (int c = 0; c < 3; ++c) {
        CHECK(ubu[c] > 0);
        CHECK(vbv[c] > 0);
        CHECK(std::abs(ubv[c] - vbu[c]) < 1e-5 * std::sqrt(ubu[c] * vbv[c]));
      }
    }
  }
}

// By power iteration in double precision on the assembled rows.
TEST_CASE("the bound of the eigenvalues is one, and not a loose one") {
  for (Model model : {Model::diffusion, Model::sp3}) {
    Scene scene({6, 3});
    const Level& level = scene.graph.levels()[0];
    const auto optical = evaluate_material(level, veined());
    const Rows rows = assemble(level, {Method::fem, Source::buried, model, optical, 1.3});
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Field> x(rows.size());
    for (Field& f : x) f = {glm::dvec3(uniform(generator)), glm::dvec3(model == Model::sp3 ? uniform(generator) : 0)};
    glm::dvec3 largest{0};
    for (int step = 0; step < 400; ++step) {
      const std::vector<Field> product = quadgraph::apply(rows, x);
      glm::dvec3 energy{0}, norm{0}, scale{0};
      for (std::size_t i = 0; i < x.size(); ++i) {
        const Field y = quadgraph::solve(rows.diagonal[i], product[i]);
        energy += dot(x[i], product[i]);
        norm += dot(x[i], rows.diagonal[i] * x[i]);
        x[i] = y;
        scale = glm::max(scale, glm::abs(y.phi));
      }
      for (Field& f : x) f = (1.0 / scale) * f;
      largest = energy / norm;
    }
    scene.simulation.set_material(veined());
    scene.light(one_side);
    scene.simulation.solve({.model = model});
    Chain chain({6, 3}, model);
    const glm::vec3 damping =
        device::download<glm::vec3>(chain.device.context, chain.operators.at(chain.key, 0).damping)[0];
    for (int c = 0; c < 3; ++c) {
      CHECK(2.0 / static_cast<double>(damping[c]) > largest[c]);
      CHECK(2.0 / static_cast<double>(damping[c]) < 1.5 * largest[c]);
    }
  }
}

// The largest Rayleigh quotient of M^-1 A in the product that A makes, per channel, by power iteration in double
// precision.
TEST_CASE("the smoother divides by at least the matrix, and not by much more") {
  for (Model model : {Model::diffusion, Model::sp3}) {
    CAPTURE(name_of(model));
    Chain chain({6, 3}, model);
    const Level& level = chain.graph.levels()[0];
    const Rows rows = assemble(level, {Method::fem, Source::buried, model, evaluate_material(level, veined()), 1.3});
    const auto stored = device::download<glm::vec3>(chain.device.context, chain.operators.at(chain.key, 0).majorant);
    const std::size_t each = model == Model::sp3 ? 3 : 1;
    const auto random = random_fields(2 * rows.size(), 3);
    std::vector<Field> x(rows.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = {glm::dvec3(random[2 * i]), model == Model::sp3 ? glm::dvec3(random[2 * i + 1]) : glm::dvec3(0)};
    }
    glm::dvec3 largest{0};
    for (int step = 0; step < 400; ++step) {
      const std::vector<Field> product = quadgraph::apply(rows, x);
      glm::dvec3 above{0}, below{0}, scale{0};
      for (std::size_t i = 0; i < x.size(); ++i) {
        const glm::vec3* m = &stored[each * i];
        const Block inverse = model == Model::sp3 ? Block{m[0], m[1], m[2]} : Block{m[0], {}, {}};
        const Field y = inverse * product[i];
        above += dot(product[i], y);
        below += dot(x[i], product[i]);
        x[i] = y;
        scale = glm::max(scale, glm::abs(y.phi));
      }
      for (Field& f : x) f = (1.0 / scale) * f;
      largest = above / below;
    }
    for (int c = 0; c < 3; ++c) {
      CHECK(largest[c] < 1);
      CHECK(largest[c] > 0.6);
    }
  }
}

TEST_CASE("cycles solve what the CPU reference solves") {
  Scene scene({8, 4, 2});
  scene.simulation.set_material(veined());
  scene.light(one_side);
  const Level& level = scene.graph.levels()[0];
  const auto optical = evaluate_material(level, veined());
  const auto q = scene.irradiance(0, one_side);
  for (Model model : {Model::diffusion, Model::sp3}) {
    for (SolverKind solver : with_cycles) {
      for (std::uint32_t smoothing : {1u, 2u}) {
        CAPTURE(name_of(solver));
        const SolveReport report =
            scene.simulation.solve({.solver = solver, .model = model, .tolerance = 1e-5, .smoothing = smoothing});
        const ReferenceSolution expected =
            solve_reference(level, optical, 1.3, {{gpu::BEAM_LAMBERTIAN, glm::vec3(0), {}, {}}, q},
                            {.model = model, .tolerance = 1e-10}, Entries::stored);
        CHECK(report.solver == solver);
        CHECK(report.replaced.empty());
        CHECK(report.levels.back().converged);
        CHECK(relative_difference(scene.simulation.surface_field().exitance, expected.exitance) < 5e-5);
        for (int c = 0; c < 3; ++c) CHECK(std::abs(report.energy.balance()[c]) < 5e-5);
      }
    }
  }
}

TEST_CASE("the number of cycles hardly depends on the size") {
  for (Model model : {Model::diffusion, Model::sp3}) {
    std::vector<std::uint32_t> cycles;
    for (const std::vector<std::uint32_t>& cells : {std::vector<std::uint32_t>{6, 3}, {12, 6, 3}}) {
      Scene scene(cells);
      scene.simulation.set_material(homogeneous(0.01f));
      scene.light(one_side);
      cycles.push_back(scene.simulation.solve({.model = model}).levels.back().iterations);
    }
    CAPTURE(name_of(model));
    const auto [least, most] = std::minmax_element(cycles.begin(), cycles.end());
    CHECK(*most - *least <= 1);
    // Tets split at their centroids are hard on a smoother: bodies from the bake take 3 to 5.
    CHECK(*most <= 12);
  }
}

TEST_CASE("the estimated algebraic error is that of the exitance, cycle by cycle") {
  Scene scene({12, 6, 3});
  scene.simulation.set_material(homogeneous(0.01f));
  scene.light(one_side);
  scene.simulation.solve({.model = Model::diffusion, .tolerance = 1e-6});
  const auto exact = scene.simulation.surface_field();
  for (SolverKind solver : with_cycles) {
    double before = 1;
    for (std::uint32_t cycles = 1; cycles <= 4; ++cycles) {
      const SolveReport report =
          scene.simulation.solve({.solver = solver, .model = Model::diffusion, .cycles = cycles});
      const double error = relative_difference(scene.simulation.surface_field().exitance, exact.exitance);
      CAPTURE(cycles);
      CHECK(report.levels.back().iterations == cycles);
      REQUIRE(report.algebraic);
      // The test's norm takes every face alike, as the box nearly does.
      CHECK(report.algebraic->whole > error / 2);
      CHECK(report.algebraic->whole < 8 * error);
      CHECK(error < 0.6 * before);
      before = error;
    }
  }
}

TEST_CASE("a warm start with one cycle a frame follows a moving light and an edited material") {
  Scene scene({8, 4, 2});
  gpu::Material material = homogeneous(0.02f);
  scene.simulation.set_material(material);
  const auto turned = [](float degrees) {
    const float a = glm::radians(degrees);
    return [=](const glm::vec3& p) {
      const glm::vec3 outward = (p - glm::vec3(5)) / 5.0f;
      return glm::vec3(std::max(0.0f, outward.x * std::cos(a) + outward.y * std::sin(a)));
    };
  };
  scene.light(turned(0));
  scene.simulation.solve({.model = Model::diffusion});
  const std::uint64_t bytes = scene.device.context.allocated_bytes();
  for (int frame = 1; frame <= 24; ++frame) {
    if (frame == 12) {
      material.sigma_a *= 0.5f;
      scene.simulation.set_material(material);
    }
    scene.light(turned(5.0f * static_cast<float>(frame)));
    const SolveReport report = scene.simulation.solve({.model = Model::diffusion, .cycles = 1, .warm = true});
    const auto warm = scene.simulation.surface_field();
    CHECK(report.levels.back().iterations == 1);
    CHECK(report.error);
    if (frame % 6 != 0) continue;
    const auto kept = warm.exitance;
    Scene fresh({8, 4, 2});
    fresh.simulation.set_material(material);
    fresh.light(turned(5.0f * static_cast<float>(frame)));
    fresh.simulation.solve({.model = Model::diffusion, .tolerance = 1e-5});
    const double error = relative_difference(kept, fresh.simulation.surface_field().exitance);
    CAPTURE(frame);
    // It neither grows nor jumps with the material. On a body from the bake it is half as much (test_frames.py).
    CHECK(error < 0.04);
  }
  CHECK(scene.device.context.allocated_bytes() == bytes);
}

TEST_CASE("graph methods and single levels have no cycles, and say so") {
  Scene chain({4, 2});
  Scene alone({4});
  for (Scene* scene : {&chain, &alone}) {
    scene->simulation.set_material(homogeneous());
    scene->light(one_side);
  }
  const SolveReport volumes = chain.simulation.solve({.method = Method::quadgraph_fv});
  CHECK(volumes.solver == SolverKind::dpcg);
  CHECK(volumes.replaced.find("quadgraph-fv") != std::string::npos);
  const SolveReport single = alone.simulation.solve({});
  CHECK(single.solver == SolverKind::dpcg);
  CHECK(single.replaced.find("coarser") != std::string::npos);
  CHECK(single.levels.back().converged);
}

TEST_CASE("auto takes the quicker of two solvers, and keeps to it until the material changes") {
  Scene scene({6, 3});
  scene.simulation.set_material(homogeneous());
  scene.light(one_side);
  const SolveOptions how{.solver = SolverKind::automatic, .model = Model::diffusion};
  const SolveReport first = scene.simulation.solve(how);
  CHECK(first.replaced.find("both tried") != std::string::npos);
  const SolveReport second = scene.simulation.solve(how);
  CHECK(second.replaced.empty());
  CHECK(first.replaced.find(std::string(name_of(second.solver)) + " from now on") != std::string::npos);
  scene.simulation.set_material(homogeneous(0.1f));
  CHECK(!scene.simulation.solve(how).replaced.empty());
}

TEST_CASE("a target for the error stops on a level as coarse as it allows, or is missed with a word") {
  Scene scene({12, 6, 3});
  scene.simulation.set_material(homogeneous(0.01f));
  scene.light([](const glm::vec3&) { return glm::vec3(1); });
  std::uint32_t before = 2;
  for (double error : {0.5, 0.05, 1e-6}) {
    const SolveReport report = scene.simulation.solve({.model = Model::diffusion, .error = error});
    CAPTURE(error);
    REQUIRE(report.error);
    CHECK(report.finest <= before);
    CHECK((confidence * std::max(report.error->whole, report.error->unlit) <= error) == report.missed.empty());
    CHECK(report.levels.back().level == report.finest);
    before = report.finest;
  }
  CHECK(before == 0);
  CHECK_THROWS_AS(scene.simulation.solve({.error = 1.5}), InputError);
  CHECK_THROWS_AS(scene.simulation.solve({.smoothing = 3}), InputError);
}

TEST_CASE("differences of levels add in quadrature") {
  // A series that halves: the error of a level is that of all finer differences, 1/4 + 1/16 + ... = 1/3 of its square.
  const ErrorEstimate error = mesh_error({0.1, 0.2, 0.3}, ErrorEstimate{0.2, 0.4, 0.6});
  CHECK(error.whole == doctest::Approx(0.1 / std::sqrt(3)));
  CHECK(error.unlit == doctest::Approx(0.2 / std::sqrt(3)));
  CHECK(mesh_error({0.1, 0.2, 0.3}, std::nullopt).whole == doctest::Approx(error.whole));
  CHECK(mesh_error({0.1, 0, 0}, ErrorEstimate{0.4, 0, 0}).whole < error.whole);
  CHECK(error.dimmest == doctest::Approx(0.3 / std::sqrt(3)));
  CHECK(mesh_error({0.1, 0, 0}, ErrorEstimate{0.1, 0, 0}).whole > error.whole);
  CHECK(mesh_error({0.1, 0, 0}, ErrorEstimate{0.1, 0, 0}).unlit == 0);
}
