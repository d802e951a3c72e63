// In which format entries lie changes no answer.
#include <doctest/doctest.h>

#include "engine/reference/stored_entries.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

using namespace quadgraph;

namespace {

struct Body {
  CheckedContext device;
  QuadGraph graph;
  Simulation simulation;

  explicit Body(const std::vector<OwnedLevel>& levels)
      : graph(QuadGraph::parse(graph_of(levels), "box")), simulation(device.context, graph) {}
};

std::vector<glm::vec3> solution(Body& body, const gpu::Material& material, const SolveOptions& options) {
  body.simulation.set_material(material);
  for (std::uint32_t i = 0; i < body.simulation.level_count(); ++i) {
    const Level& level = body.graph.levels()[i];
    std::vector<glm::vec3> q;
    for (std::uint32_t f = 0; f < level.face_count(); ++f) q.push_back(one_side(level.nodes[level.tet_count() + f]));
    body.simulation.set_irradiance(i, q, glm::vec3(1, 0.2f, 0));
  }
  body.simulation.solve(options);
  return body.simulation.surface_field().exitance;
}

}  // namespace

TEST_CASE("a body squeezed until packed entries would round too much is solved like one of that shape") {
  const auto squeeze = [](glm::vec3 p) { return p * glm::vec3(0.01f, 0.01f, 10.0f); };
  std::vector<OwnedLevel> levels = {split_at_corners(box_level(4, 10.0f, 0.15f)),
                                    split_at_corners(box_level(2, 10.0f, 0.15f))};
  Body moved(levels);
  for (OwnedLevel& level : levels) {
    for (glm::vec3& p : level.vertices) p = squeeze(p);
  }
  Body fresh(levels);
  const gpu::Material material = homogeneous();
  const SolveOptions options{.model = Model::sp3, .tolerance = 1e-5};
  solution(moved, material, options);  // with packed entries
  for (std::uint32_t i = 0; i < moved.simulation.level_count(); ++i) {
    CHECK(format_of(moved.graph.levels()[i], Method::fem) == EntryFormat::packed);
    CHECK(format_of(fresh.graph.levels()[i], Method::fem) == EntryFormat::plain);
    moved.simulation.set_vertices(i, fresh.graph.levels()[i].vertices);
  }
  CHECK(relative_difference(solution(moved, material, options), solution(fresh, material, options)) < 1e-4);
}
