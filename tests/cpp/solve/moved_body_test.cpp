// A body whose vertices move: what it sees of itself, its operators and its source follow.
#include <algorithm>

#include "engine/base/error.h"
#include "engine/reference/sky.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

using namespace quadgraph;

namespace {

struct MovedBody {
  CheckedContext device;
  QuadGraph graph;
  Simulation simulation;
  glm::vec3 down{0, -1, 0};

  explicit MovedBody(const std::vector<OwnedLevel>& levels)
      : graph(QuadGraph::parse(graph_of(levels), "body")), simulation(device.context, graph) {
    simulation.set_material(veined());
  }

  void move(const Motion& motion) {
    for (std::uint32_t i = 0; i < simulation.level_count(); ++i) {
      std::vector<glm::vec3> positions;
      for (const glm::vec3& p : graph.levels()[i].vertices) positions.push_back(motion(p));
      simulation.set_vertices(i, positions);
    }
  }

  // Light on what is the upper side of the slabs at rest, straight from above. (Lambertian light would not do: its rays
  // do not turn with the body.)
  void light() {
    for (std::uint32_t i = 0; i < simulation.level_count(); ++i) {
      const Level& level = graph.levels()[i];
      std::vector<glm::vec3> q;
      for (std::uint32_t f = 0; f < level.face_count(); ++f) {
        q.emplace_back(level.nodes[level.tet_count() + f].y > 3.99f ? 1.0f : 0.0f);
      }
      simulation.set_irradiance(i, q, down);
    }
  }

  SurfaceField solve(const SolveOptions& options) {
    light();
    const SolveReport report = simulation.solve(options);
    CHECK(report.inter_reflection);
    CHECK(report.energy.re_entered.x > 0.01 * report.energy.entered.x);
    for (int c = 0; c < 3; ++c) CHECK(std::abs(report.energy.balance()[c]) < 1e-4);
    return simulation.surface_field();
  }
};

const std::vector<OwnedLevel>& two_levels() {
  static const std::vector<OwnedLevel> levels = {facing_slabs(3, 10.0f, 2.0f, 4.0f),
                                                 baked(facing_slabs(2, 10.0f, 2.0f, 4.0f))};
  return levels;
}

}  // namespace

TEST_CASE("a body whose vertices have moved answers as one baked in that shape") {
  const OwnedLevel shape = two_levels()[1];  // alone: transfers stay those of the rest
  for (const Method method : {Method::fem, Method::quadgraph_fv}) {
    CAPTURE(name_of(method));
    MovedBody body({shape});
    const SurfaceField rest = body.solve(accurate(method));
    body.move([](const glm::vec3& p) { return p; });
    CHECK(relative_difference(body.solve(accurate(method)).exitance, rest.exitance) < 1e-4);
    body.move(turned);
    body.down = turned({0, -1, 0}) - turned({0, 0, 0});
    CHECK(relative_difference(body.solve(accurate(method)).exitance, rest.exitance) < 1e-4);
    body.move(bent);
    body.down = {0, -1, 0};
    const SurfaceField found = body.solve(accurate(method));
    CHECK(relative_difference(found.exitance, rest.exitance) > 1e-2);

    // A file of the moved shape. The material must stay with the body, so it gets that of the nodes at rest.
    MovedBody fresh({baked(moved(shape, bent))});
    fresh.simulation.set_optical(0, evaluate_material(body.graph.levels()[0], veined()), veined().eta);
    fresh.simulation.set_irradiance(0, device::download<glm::vec3>(body.device.context, body.simulation.level(0).q),
                                    body.down);
    fresh.simulation.solve(accurate(method));
    const SurfaceField expected = fresh.simulation.surface_field();
    CHECK(relative_difference(found.position, expected.position) < 1e-6);
    CHECK(relative_difference(found.exitance, expected.exitance) < 1e-4);
  }
}

TEST_CASE("levels finer and coarser than the one with the matrix see the sky as the reference carries it to them") {
  MovedBody body({facing_slabs(4, 10.0f, 2.0f, 4.0f), baked(facing_slabs(3, 10.0f, 2.0f, 4.0f)),
                  facing_slabs(2, 10.0f, 2.0f, 4.0f)});
  const auto sky = [&](std::uint32_t i) {
    return device::download<float>(body.device.context, body.simulation.level(i).sky);
  };
  const std::vector<float> at_rest = sky(1);
  body.move(bent);
  body.solve(accurate(Method::fem));
  CHECK(relative_difference(sky(1), at_rest) > 1e-3);
  std::vector<std::vector<glm::vec3>> positions;
  std::vector<Level> shape = body.graph.levels();
  for (const Level& level : shape) {
    positions.emplace_back();
    for (const glm::vec3& p : level.vertices) positions.back().push_back(bent(p));
  }
  for (std::size_t i = 0; i < shape.size(); ++i) shape[i].vertices = positions[i];
  const auto expected = sky_of_levels(shape, 1, sky(1));
  for (std::uint32_t i = 0; i < 3; ++i) {
    CAPTURE(i);
    const std::vector<float> found = sky(i);
    CHECK(relative_difference(found, expected[i]) < 1e-6);
    const auto [least, most] = std::ranges::minmax(found);
    CHECK(least < 0.95f);
    CHECK(most <= 1.000001f);
  }
}

TEST_CASE("in motion the matrix is refreshed in parts, and comes to rest with the body") {
  MovedBody body(two_levels());
  body.move(bent);
  SolveOptions options = accurate(Method::fem);
  const SurfaceField expected = body.solve(options);
  CHECK(pass_count(body.simulation, "exchange rays") == 1);
  body.move([](const glm::vec3& p) { return p; });
  body.solve(options);
  body.move(bent);
  options.exchange_rows = 40;
  options.bounces = 1;
  body.light();
  std::uint32_t solves = 0;
  while (body.simulation.solve(options).exchange_age > 0) REQUIRE(++solves < 100);
  CHECK(solves == (two_levels()[1].faces.size() - 1) / 40);
  for (int k = 0; k < 6; ++k) body.simulation.solve(options);
  CHECK(pass_count(body.simulation, "exchange rays") == 0);
  CHECK(relative_difference(body.simulation.surface_field().exitance, expected.exitance) < 1e-4);
}

TEST_CASE("positions that make no body are refused, and nothing moves") {
  MovedBody body(two_levels());
  const Level& level = body.graph.levels()[0];
  const std::vector<glm::vec3> good(level.vertices.begin(), level.vertices.end());
  const auto refused = [&](std::uint32_t number, const std::vector<glm::vec3>& positions, const char* word) {
    CHECK_THROWS_WITH_AS(body.simulation.set_vertices(number, positions), doctest::Contains(word), InputError);
  };
  refused(2, good, "there are 2");
  refused(0, {good.begin(), good.end() - 1}, "one for each");
  std::vector<glm::vec3> bad = good;
  bad[3].y = std::numeric_limits<float>::quiet_NaN();
  refused(0, bad, "vertex 3");
  bad = good;
  for (glm::vec3& p : bad) p.z = -p.z;
  refused(0, bad, "tet 0");
  CHECK(device::download<glm::vec3>(body.device.context, body.simulation.level(0).vertices) == good);
}
