// What speaks against an answer, on reports that are wrong in one way each.
#include "engine/render/verdict.h"

#include <doctest/doctest.h>

#include <limits>

#include "engine/base/error.h"
#include "tests/cpp/fixtures/test_graphs.h"

using namespace quadgraph;

namespace {

constexpr float inf = std::numeric_limits<float>::infinity();

SolveReport good() {
  SolveReport report;
  report.levels = {{.level = 1, .converged = true}, {.level = 0, .converged = true}};
  report.energy = {.entered = glm::dvec3(1), .scattered_out = glm::dvec3(0.7), .absorbed = glm::dvec3(0.3)};
  report.algebraic = ErrorEstimate{.whole = 1e-4, .unlit = 1e-4, .dimmest = 1e-4};
  return report;
}

SolveReport judged(SolveReport report, const std::vector<Light>& lights, const std::vector<bool>& inside) {
  judge(report, lights, inside);
  return report;
}

}  // namespace

TEST_CASE("an answer that is right is left alone") {
  const SolveReport report = judged(good(), {parse_light("ambient:1")}, {false});
  CHECK(report.stopped.empty());
  CHECK(report.light_warning.empty());
  CHECK(report.levels.back().converged);
}

TEST_CASE("a value that is not finite is never converged") {
  for (glm::dvec3 Energy::* part : {&Energy::entered, &Energy::scattered_out, &Energy::absorbed, &Energy::re_entered}) {
    SolveReport report = good();
    (report.energy.*part)[1] = static_cast<double>(inf);
    report = judged(report, {parse_light("ambient:1")}, {false});
    CHECK(report.stopped.starts_with("not finite: "));
    CHECK_FALSE(report.levels.back().converged);
  }
  SolveReport report = good();
  report.algebraic->whole = std::numeric_limits<double>::quiet_NaN();
  CHECK(judged(report, {}, {}).stopped.starts_with("not finite: "));
}

TEST_CASE("what is out of balance beyond the printed error is never converged, and says which methods conserve") {
  SolveReport report = good();
  report.method = Method::quadgraph_fdm;
  report.energy.absorbed = glm::dvec3(0.25);
  const SolveReport out = judged(report, {}, {});
  CHECK(out.stopped.starts_with("out of balance: 5% of the light"));
  CHECK(out.stopped.find("quadgraph-fdm does not conserve") != std::string::npos);
  CHECK_FALSE(out.levels.back().converged);
  report.error = ErrorEstimate{.whole = 0.06, .unlit = 0.02, .dimmest = 0.02};
  CHECK(judged(report, {}, {}).stopped.empty());
}

TEST_CASE("a channel with little light counts by it in the balance, as in the error") {
  SolveReport report = good();
  report.energy = {.entered = {1, 1, 0.1}, .scattered_out = {0.7, 0.7, 0.02}, .absorbed = {0.3, 0.3, 0.03}};
  report.error = ErrorEstimate{.whole = 0.04, .unlit = 0.01, .dimmest = 0.01};
  CHECK(judged(report, {}, {}).stopped.empty());
  report.error->whole = 0.03;
  CHECK(judged(report, {}, {}).stopped.starts_with("out of balance: 3.5% of the light"));
}

TEST_CASE("a body that no light reaches is named with the lights and why") {
  SolveReport dark = good();
  dark.energy = {};
  const std::vector<Light> lights = {parse_light("point:0,0,0:1"), parse_light("spot:0,0,9:0,0,1:10:1")};
  const SolveReport report = judged(dark, lights, {true, false});
  CHECK(report.stopped.find("not lit") == 0);
  CHECK(report.stopped.find("light 1 (point) is in the body") != std::string::npos);
  CHECK(report.stopped.find("light 2 (spot) is aimed past it") != std::string::npos);
  CHECK_FALSE(report.levels.back().converged);
  CHECK(judged(dark, {parse_light("ambient:0")}, {false}).stopped.empty());  // switched off
  CHECK(judged(good(), lights, {true, false}).light_warning.starts_with("light 1 (point) is in the body"));
}

TEST_CASE("a point is inside or outside of a body") {
  const QuadGraph graph = QuadGraph::parse(box_graph({2, 2, 2}, 4), "box");
  const Level& level = graph.levels()[0];
  CHECK(is_inside(level, {2.0f, 2.1f, 1.9f}));
  CHECK(is_inside(level, {0.01f, 2.0f, 2.0f}));
  CHECK_FALSE(is_inside(level, {-0.01f, 2.0f, 2.0f}));
  CHECK_FALSE(is_inside(level, {4.1f, 4.1f, 4.1f}));
}

TEST_CASE("numbers of lights are bounded where they enter") {
  for (const char* text : {"directional:0,0,-1:1e38", "ambient:1e16", "point:0,0,1e20:1", "spot:0,0,1:0,0,-1:1e-20:1",
                           "rectangle:0,0,9:1e10,0,0:0,1,0:1"}) {
    CHECK_THROWS_AS(check_light(parse_light(text)), InputError);
  }
  for (const char* text : {"directional:0,0,-1:1e15", "point:0,0,1e9:1", "spot:0,0,1:0,0,-1:0.1:1"}) {
    CHECK_NOTHROW(check_light(parse_light(text)));
  }
}
