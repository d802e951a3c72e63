// In which format entries lie changes no answer.
#include <doctest/doctest.h>

#include "engine/reference/stored_entries.h"
#include "tests/cpp/fixtures/solved_body.h"

using namespace quadgraph;

TEST_CASE("a body squeezed until packed entries would round too much is solved like one of that shape") {
  const auto squeeze = [](glm::vec3 p) { return p * glm::vec3(0.01f, 0.01f, 10.0f); };
  std::vector<OwnedLevel> levels = {split_at_corners(box_level(4, 10.0f, 0.15f)),
                                    split_at_corners(box_level(2, 10.0f, 0.15f))};
  SolvedBody moved(open_device(test_device()), graph_of(levels));
  for (OwnedLevel& level : levels) {
    for (auto* points : {&level.vertices, &level.nodes}) {
      for (glm::vec3& p : *points) p = squeeze(p);
    }
  }
  SolvedBody fresh(open_device(test_device()), graph_of(levels));
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

TEST_CASE("a body that was first solved elsewhere is at rest again what it was there") {
  const std::vector<OwnedLevel> levels = {split_at_corners(box_level(4, 10.0f, 0.15f)),
                                          split_at_corners(box_level(2, 10.0f, 0.15f))};
  SolvedBody moved(open_device(test_device()), graph_of(levels)), fresh(open_device(test_device()), graph_of(levels));
  const gpu::Material material = homogeneous();
  const SolveOptions options{.model = Model::sp3, .tolerance = 1e-6};
  for (std::uint32_t i = 0; i < moved.simulation.level_count(); ++i) {
    std::vector<glm::vec3> longer(moved.graph.levels()[i].vertices.begin(), moved.graph.levels()[i].vertices.end());
    for (glm::vec3& p : longer) p *= glm::vec3(1.0f, 1.0f, 1.5f);
    moved.simulation.set_vertices(i, longer);
  }
  const auto rest = solution(fresh, material, options);
  CHECK(relative_difference(solution(moved, material, options), rest) > 0.01);
  moved.simulation.set_deformation({}, {});
  CHECK(relative_difference(solution(moved, material, options), rest) < 1e-5);
}
