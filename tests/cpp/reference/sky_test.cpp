// The view of the sky on every level, from the one level that knows.
#include "engine/reference/sky.h"

#include <doctest/doctest.h>

#include "engine/reference/exchange.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"
#include "tests/cpp/fixtures/test_data.h"

using namespace quadgraph;

TEST_CASE("every level sees the sky as it would by its own rays, but for what transfers smear") {
  const std::vector<OwnedLevel> slabs = {facing_slabs(6, 12.0f, 6.0f, 1.0f), facing_slabs(5, 12.0f, 6.0f, 1.0f),
                                         facing_slabs(4, 12.0f, 6.0f, 1.0f)};
  std::vector<OwnedLevel> own = slabs;
  std::vector<std::vector<double>> expected;
  for (OwnedLevel& level : own) {
    bake_seen(level, 16);
    expected.push_back(sky_visibility(level.view()));
  }
  for (const std::size_t known : {0, 2}) {
    if (sanitized && known == 0) continue;
    std::vector<OwnedLevel> levels = slabs;
    levels[known] = own[known];
    const QuadGraph graph = QuadGraph::parse(graph_of(levels), "slabs");
    const auto sky = sky_of_levels(graph.levels());
    REQUIRE(sky.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      CAPTURE(known);
      CAPTURE(i);
      const auto faces = static_cast<double>(expected[i].size());
      double difference = 0, hidden = 0;
      for (std::size_t f = 0; f < expected[i].size(); ++f) {
        difference += std::abs(double{sky[i][f]} - expected[i][f]) / faces;
        hidden += (1 - expected[i][f]) / faces;
      }
      CHECK(hidden > 0.1);
      CHECK(difference < (i == known ? 1e-6 : hidden / 3));
    }
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
