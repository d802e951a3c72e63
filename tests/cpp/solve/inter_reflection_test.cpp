// Inter-reflection on the GPU: closed forms, conservation, and what it must leave alone.
#include <functional>

#include "engine/reference/exchange.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

using namespace quadgraph;

namespace {

struct Body {
  CheckedContext device;
  QuadGraph graph;
  Simulation simulation;

  explicit Body(const std::vector<OwnedLevel>& levels)
      : graph(QuadGraph::parse(graph_of(levels), "body")), simulation(device.context, graph) {}

  void light(const std::function<glm::vec3(const glm::vec3&)>& q_at) {
    for (std::uint32_t i = 0; i < simulation.level_count(); ++i) {
      const Level& level = graph.levels()[i];
      std::vector<glm::vec3> q;
      for (std::uint32_t f = 0; f < level.face_count(); ++f) q.push_back(q_at(level.nodes[level.tet_count() + f]));
      simulation.set_irradiance(i, q);
    }
  }
};

gpu::Material material(float eta, float sigma_a = 0.02f) {
  gpu::Material made = homogeneous(sigma_a);
  made.eta = eta;
  return made;
}

void check_energy(const SolveReport& report, double tolerance) {
  for (int c = 0; c < 3; ++c) CHECK(std::abs(report.energy.balance()[c]) < tolerance);
}

glm::dvec3 sum(const std::vector<glm::dvec3>& values) {
  return std::accumulate(values.begin(), values.end(), glm::dvec3(0));
}

}  // namespace

TEST_CASE("inside a shell every bounce brings the same share of the one before, for ever") {
  Body body({baked(shell_level(4, 2, 3.0, 5.0))});
  body.light([](const glm::vec3& p) { return glm::length(p) > 4 ? glm::vec3(1, 0.8f, 0.6f) : glm::vec3(0); });
  for (const float eta : {1.0f, 1.3f}) {
    for (const Method method : {Method::fem, Method::quadgraph_fv}) {
      CAPTURE(eta);
      CAPTURE(name_of(method));
      body.simulation.set_material(material(eta));
      const SolveReport report = body.simulation.solve(accurate(method));
      CHECK(report.inter_reflection);
      REQUIRE(report.bounces.size() > 4);
      CHECK(report.bounces[0].x > 0.02 * report.energy.entered.x);
      for (int c = 0; c < 3; ++c) {
        CAPTURE(c);
        const double share = report.bounces[2][c] / report.bounces[1][c];
        CHECK(report.bounces[3][c] / report.bounces[2][c] == doctest::Approx(share).epsilon(2e-3));
        // Without reflection at the surface the series is that of a single number.
        const double expected = report.bounces[0][c] + report.bounces[1][c] / (1 - share);
        CHECK(report.energy.re_entered[c] == doctest::Approx(expected).epsilon(2e-3));
        CHECK(sum(report.bounces)[c] == doctest::Approx(report.energy.re_entered[c]).epsilon(1e-5));
      }
      check_energy(report, 1e-4);
    }
  }
}

TEST_CASE("what leaves a closed cavity enters it again, all of it, and uniformly where it left uniformly") {
  Body body({baked(shell_level(4, 2, 3.0, 5.0))});
  body.light([](const glm::vec3& p) { return glm::length(p) > 4 ? glm::vec3(1) : glm::vec3(0); });
  for (const float eta : {1.0f, 1.4f}) {
    CAPTURE(eta);
    body.simulation.set_material(material(eta));
    const SolveReport report = body.simulation.solve(accurate());
    const SurfaceField field = body.simulation.surface_field();
    const LevelBuffers& level = body.simulation.level(0);
    const auto beams = device::download<glm::vec3>(body.device.context, level.beam_q);
    const std::size_t again = beams.size() - level.face_count;
    glm::dvec3 left{0}, enters{0};
    double least = 1e30, most = 0;
    for (std::size_t f = 0; f < field.area.size(); ++f) {
      const glm::vec3 q = beams[again + f];
      if (glm::length(field.position[f]) > 4) {
        CHECK(q == glm::vec3(0));
        continue;
      }
      left += double{field.area[f]} * glm::dvec3(field.exitance[f]);
      enters += double{field.area[f]} * glm::dvec3(q);
      least = std::min(least, double{q.x});
      most = std::max(most, double{q.x});
    }
    for (int c = 0; c < 3; ++c) {
      CHECK(enters[c] == doctest::Approx(left[c]).epsilon(1e-4));
      CHECK(report.energy.re_entered[c] == doctest::Approx(left[c]).epsilon(1e-4));
    }
    CHECK(most / least < 1.1);
  }
}

TEST_CASE("two facing slabs light each other, and finer levels get the same power") {
  const OwnedLevel coarse = facing_slabs(2, 10.0f, 2.0f, 2.0f), fine = facing_slabs(4, 10.0f, 2.0f, 2.0f);
  for (const bool on_finest : {true, false}) {
    CAPTURE(on_finest);
    Body body(on_finest ? std::vector{baked(fine), coarse} : std::vector{fine, baked(coarse)});
    body.light([](const glm::vec3& p) { return p.y > 2.99f ? glm::vec3(1, 0.5f, 0.25f) : glm::vec3(0); });
    body.simulation.set_material(material(1.0f));
    SolveOptions options = accurate();
    const SolveReport with = body.simulation.solve(options);
    const SurfaceField lit = body.simulation.surface_field();
    check_energy(with, 1e-4);
    REQUIRE(with.error);
    options.inter_reflection = false;
    const SolveReport without = body.simulation.solve(options);
    const SurfaceField dark = body.simulation.surface_field();
    check_energy(without, 1e-4);
    CHECK_FALSE(without.inter_reflection);
    CHECK(without.bounces.empty());
    CHECK(without.energy.re_entered == glm::dvec3(0));
    // The lower slab has no other light.
    double below = 0, before = 0;
    for (std::size_t f = 0; f < lit.area.size(); ++f) {
      if (lit.position[f].y > 0) continue;
      below += double{lit.area[f] * lit.exitance[f].x};
      before += double{dark.area[f] * dark.exitance[f].x};
    }
    CHECK(before == 0);
    CHECK(below > 0.01 * with.energy.entered.x);
    CHECK(with.error->whole < 1.5 * without.error->whole);
  }
}

TEST_CASE("the bounces are those of the CPU, for every conservative method and model") {
  Body body({baked(facing_slabs(2, 10.0f, 2.0f, 2.0f))});
  const Level& level = body.graph.levels()[0];
  const auto q_at = [](const glm::vec3& p) { return p.y > 2.99f ? glm::vec3(1, 0.5f, 0.25f) : glm::vec3(0); };
  body.light(q_at);
  std::vector<glm::vec3> q;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) q.push_back(q_at(level.nodes[level.tet_count() + f]));
  const EnteringLight light{{gpu::BEAM_LAMBERTIAN, glm::vec3(0), {}, {}}, q};
  for (const Case& what : all_cases()) {
    if (what.source == Source::diffuse || what.method == Method::quadgraph_fdm) continue;
    for (const float eta : {1.0f, 1.4f}) {
      CAPTURE(what);
      CAPTURE(eta);
      body.simulation.set_material(material(eta));
      SolveOptions options = what.options(SolverKind::dpcg, 1e-6);
      const SolveReport found = body.simulation.solve(options);
      const SurfaceField field = body.simulation.surface_field();
      options.tolerance = 1e-7;
      const BouncedSolution expected =
          solve_with_bounces(level, evaluate_material(level, material(eta)), static_cast<double>(eta), {&light, 1},
                             options, Entries::stored);
      CHECK(relative_difference(field.exitance, expected.solution.exitance) < 1e-4);
      CHECK(relative_difference(field.unscattered, expected.solution.unscattered) < 1e-4);
      for (int c = 0; c < 3; ++c) {
        CHECK(found.energy.re_entered[c] == doctest::Approx(expected.solution.energy.re_entered[c]).epsilon(1e-4));
        for (std::size_t k = 0; k < 3; ++k) {
          CHECK(found.bounces.at(k)[c] == doctest::Approx(expected.bounces[k][c]).epsilon(1e-3));
        }
      }
    }
  }
}

TEST_CASE("a convex body sees nothing of itself") {
  for (const OwnedLevel& shape : {split_at_centroids(box_level(2, 6.0f)), ball_level(4, 5.0)}) {
    const OwnedLevel level = baked(shape);
    CHECK(level.seen.size() == level.faces.size() + 1);
    Body body({level});
    body.light([](const glm::vec3&) { return glm::vec3(1); });
    body.simulation.set_material(material(1.3f));
    const SolveReport report = body.simulation.solve(accurate());
    CHECK(report.inter_reflection);
    CHECK(report.bounces.empty());
    CHECK(report.energy.re_entered == glm::dvec3(0));
    check_energy(report, 1e-4);
  }
}

TEST_CASE("one bounce a solve, from the last state, comes to the still") {
  Body body({facing_slabs(3, 10.0f, 2.0f, 2.0f), baked(facing_slabs(2, 10.0f, 2.0f, 2.0f))});
  body.light([](const glm::vec3& p) { return p.y > 2.99f ? glm::vec3(1, 0.5f, 0.25f) : glm::vec3(0); });
  body.simulation.set_material(material(1.2f));
  SolveOptions options = accurate();
  const SolveReport still = body.simulation.solve(options);
  const std::vector<glm::vec3> expected = body.simulation.surface_field().exitance;
  options.inter_reflection = false;
  body.simulation.solve(options);  // forgets the state
  options.inter_reflection = true;
  options.bounces = 1;
  double before = 1;
  for (int frame = 0; frame < 8; ++frame) {
    const SolveReport report = body.simulation.solve(options);
    CHECK(report.bounces.size() == 1);
    check_energy(report, 1e-4);
    const double error = relative_difference(body.simulation.surface_field().exitance, expected);
    if (frame > 0 && before > 1e-4) CHECK(error < 0.5 * before);
    before = error;
  }
  CHECK(before < 1e-4);
  // And it follows the light.
  body.light([](const glm::vec3& p) { return p.y > 2.99f ? glm::vec3(2, 1, 0.5f) : glm::vec3(0); });
  for (int frame = 0; frame < 8; ++frame) body.simulation.solve(options);
  std::vector<glm::vec3> doubled = expected;
  for (glm::vec3& m : doubled) m *= 2.0f;
  CHECK(relative_difference(body.simulation.surface_field().exitance, doubled) < 1e-4);
}

TEST_CASE(
    "switched off, or with light that enters at the surface, everything is as in a body that does not see itself") {
  const OwnedLevel shape = facing_slabs(3, 10.0f, 2.0f, 2.0f);
  Body seeing({baked(shape)}), blind({shape});
  const auto q = [](const glm::vec3& p) { return p.y > 2.99f ? glm::vec3(1, 0.5f, 0.25f) : glm::vec3(0.1f); };
  for (Body* body : {&seeing, &blind}) {
    body->light(q);
    body->simulation.set_material(material(1.3f));
  }
  for (const Case& what : all_cases()) {
    CAPTURE(what);
    SolveOptions options = what.options(SolverKind::dpcg, 1e-4);
    const SolveReport expected = blind.simulation.solve(options);
    CHECK_FALSE(expected.inter_reflection);
    if (what.source == Source::buried) {
      // Leaves nothing behind; what quadgraph-fdm makes of light is more than enters, and is not followed.
      CHECK(seeing.simulation.solve(options).inter_reflection == (what.method != Method::quadgraph_fdm));
      options.inter_reflection = false;
    }
    const SolveReport report = seeing.simulation.solve(options);
    CHECK_FALSE(report.inter_reflection);
    CHECK(report.energy.absorbed == expected.energy.absorbed);
    CHECK(report.energy.unscattered_out == expected.energy.unscattered_out);
    const SurfaceField found = seeing.simulation.surface_field(), wanted = blind.simulation.surface_field();
    CHECK(found.exitance == wanted.exitance);
    CHECK(found.unscattered == wanted.unscattered);
    const auto beams = device::download<glm::vec3>(seeing.device.context, seeing.simulation.level(0).beam_q);
    CHECK(std::all_of(beams.end() - static_cast<std::ptrdiff_t>(shape.faces.size()), beams.end(),
                      [](const glm::vec3& value) { return value == glm::vec3(0); }));
  }
}

TEST_CASE("bounces repeat bit for bit, and relaxation comes to what conjugate gradients do") {
  Body body({facing_slabs(3, 10.0f, 2.0f, 2.0f), baked(facing_slabs(2, 10.0f, 2.0f, 2.0f))});
  body.light([](const glm::vec3& p) { return p.y > 2.99f ? glm::vec3(1, 0.5f, 0.25f) : glm::vec3(0); });
  body.simulation.set_material(material(1.3f));
  for (const Model model : {Model::diffusion, Model::sp3}) {
    SolveOptions options = accurate();
    options.model = model;
    const SolveReport report = body.simulation.solve(options);
    const std::vector<glm::vec3> first = body.simulation.surface_field().exitance;
    CHECK(body.simulation.solve(options).bounces == report.bounces);
    CHECK(body.simulation.surface_field().exitance == first);
    options.solver = SolverKind::cascade;
    options.max_iterations = 20000;
    const SolveReport relaxed = body.simulation.solve(options);
    check_energy(relaxed, 1e-4);
    CHECK(relative_difference(body.simulation.surface_field().exitance, first) < 1e-4);
    for (int c = 0; c < 3; ++c) {
      CHECK(relaxed.energy.re_entered[c] == doctest::Approx(report.energy.re_entered[c]).epsilon(1e-4));
    }
  }
}
