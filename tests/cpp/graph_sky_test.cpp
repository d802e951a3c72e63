// The view of the sky on every level, from the one level that knows.
#include <doctest/doctest.h>

#include "engine/graph/sky.h"
#include "tests/cpp/exchange_fixtures.h"

using namespace quadgraph;

namespace {

// Between two large slabs the inner faces see little of the sky; the outer ones all of it, but for what a transfer
// takes from the rims.
void check_slabs(const Level& level, std::span<const float> sky, float outside) {
  REQUIRE(sky.size() == level.faces.size());
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const float y = std::abs(level.nodes[level.tet_count() + f].y);
    CAPTURE(f);
    CHECK(sky[f] >= 0.0f);
    CHECK(sky[f] <= 1.0f + 1e-6f);
    if (y > 2.5f) CHECK(sky[f] >= outside);
    if (y < 0.6f) CHECK(sky[f] < 0.5f);
  }
}

}  // namespace

TEST_CASE("every level sees the sky as the level that knows") {
  for (std::size_t known = 0; known < 3; ++known) {
    CAPTURE(known);
    std::vector<OwnedLevel> levels = {facing_slabs(4, 12.0f, 3.0f, 1.0f), facing_slabs(3, 12.0f, 3.0f, 1.0f),
                                      facing_slabs(2, 12.0f, 3.0f, 1.0f)};
    bake_seen(levels[known], 64);
    const QuadGraph graph = QuadGraph::parse(graph_of(levels), "slabs");
    const auto sky = sky_of_levels(graph.levels());
    REQUIRE(sky.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) check_slabs(graph.levels()[i], sky[i], i == known ? 1.0f : 0.9f);
  }
}

TEST_CASE("a body of which nothing is known sees all of the sky") {
  const QuadGraph graph = QuadGraph::parse(box_graph({3, 2}, 5.0f), "box");
  for (const std::vector<float>& level : sky_of_levels(graph.levels())) {
    for (const float sky : level) CHECK(sky == 1.0f);
  }
}

TEST_CASE("a coarse face sees the mean of what its fine ones see, and constants stay") {
  const QuadGraph graph = QuadGraph::parse(box_graph({4, 3, 2}, 5.0f), "box");
  const std::vector<float> sky(graph.levels()[1].faces.size(), 0.25f);
  for (const std::vector<float>& level : sky_of_levels(graph.levels(), 1, sky)) {
    for (const float value : level) CHECK(value == doctest::Approx(0.25f));
  }
}
