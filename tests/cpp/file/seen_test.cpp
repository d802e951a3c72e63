// What the faces see of each other, as stored: read as written, and every broken rule refused by its name.
#include <doctest/doctest.h>

#include <functional>
#include <random>
#include <string>

#include "engine/base/error.h"
#include "tests/cpp/fixtures/qgraph_bytes.h"
#include "tests/cpp/fixtures/test_graphs.h"

using namespace quadgraph;

namespace {

// A cube of 12 faces of which 2 sees 5 twice and 7, and 11 sees 0.
OwnedLevel seeing_cube() {
  OwnedLevel level = split_at_centroids(box_level(1, 1.0f));
  level.seen = {13, 13, 13, 16, 16, 16, 16, 16, 16, 16, 16, 16, 17, 5, 5, 7, 0};
  level.seen_rays = 3;
  return level;
}

std::string refusal(const std::vector<std::byte>& bytes) {
  try {
    QuadGraph::parse(bytes, "seen.qgraph");
  } catch (const FormatError& error) {
    return error.what();
  }
  return {};
}

std::string refusal_after(const std::function<void(OwnedLevel&)>& change) {
  OwnedLevel level = seeing_cube();
  change(level);
  return refusal(graph_of(level));
}

// Walks rows as the engine does; false where that would leave the arrays.
bool safe_to_use(const Level& level) {
  if (level.seen.empty()) return true;
  for (std::size_t f = 0; f < level.faces.size(); ++f) {
    if (level.seen[f] > level.seen[f + 1] || level.seen[f + 1] > level.seen.size()) return false;
    if (level.seen[f + 1] - level.seen[f] > level.seen_rays) return false;
    for (std::uint32_t k = level.seen[f]; k < level.seen[f + 1]; ++k) {
      if (level.seen[k] >= level.faces.size() || level.seen[k] == f) return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("what faces see is optional and read as written") {
  const OwnedLevel level = seeing_cube();
  const QuadGraph graph = QuadGraph::parse(graph_of(level), "seen");
  const Level& read = graph.levels()[0];
  CHECK(read.seen_rays == 3);
  CHECK(std::vector<std::uint32_t>(read.seen.begin(), read.seen.end()) == level.seen);
  const QuadGraph plain = QuadGraph::parse(graph_of(split_at_centroids(box_level(1, 1.0f))), "plain");
  CHECK(plain.levels()[0].seen.empty());
  CHECK(plain.levels()[0].seen_rays == 0);
}

TEST_CASE("a body that sees nothing of itself has rows without entries") {
  OwnedLevel level = seeing_cube();
  level.seen.assign(13, 13);
  CHECK(QuadGraph::parse(graph_of(level), "sky").levels()[0].seen.size() == 13);
}

TEST_CASE("broken rules of what faces see are named") {
  struct Case {
    std::function<void(OwnedLevel&)> change;
    std::string said;
  };
  const std::vector<Case> cases = {
      {[](auto& l) { l.seen_rays = 0; }, "level0/seen_rays: 0 found, 1 or more allowed"},
      {[](auto& l) { l.seen_rays = 2; }, "level0/seen: row 2: more entries than seen_rays"},
      {[](auto& l) { l.seen.resize(12); }, "level0/seen: 12 values, expected at least 13"},
      {[](auto& l) { l.seen[0] = 12; }, "level0/seen: row 0: must begin at 13"},
      {[](auto& l) { l.seen.push_back(1); }, "level0/seen: the last row ends at 17, the section at 18"},
      {[](auto& l) { l.seen[12] = 18; }, "level0/seen: the last row ends at 18, the section at 17"},
      {[](auto& l) { l.seen[4] = 15; }, "level0/seen: row 3: ends before it begins"},
      {[](auto& l) { l.seen[1] = 4000000000u; }, "level0/seen: row 0: more entries than seen_rays"},
      {[](auto& l) { l.seen[16] = 12; }, "level0/seen: row 11: face 12, allowed is below 12"},
      {[](auto& l) { l.seen[16] = 11; }, "level0/seen: row 11: a face does not see itself"},
      {[](auto& l) { std::swap(l.seen[14], l.seen[15]); }, "level0/seen: row 2: faces are not in ascending order"},
  };
  for (const Case& broken : cases) {
    const std::string message = refusal_after(broken.change);
    INFO("said '" << message << "'");
    CHECK(message.find(broken.said) != std::string::npos);
  }
}

TEST_CASE("only one level may tell what its faces see") {
  const std::string message = refusal(graph_of({seeing_cube(), seeing_cube()}));
  INFO("said '" << message << "'");
  CHECK(message.find("level1/seen: only one level may have it") != std::string::npos);
}

TEST_CASE("rows of what faces see need the number of rays, and the number the rows") {
  for (const std::string kept : {"level0/seen", "level0/seen_rays"}) {
    std::vector<std::byte> bytes = graph_of(seeing_cube());
    for (std::size_t i = 0; i < entries_present(bytes); ++i) {
      auto section = read_at<QgraphSection>(bytes, entry_offset(i));
      const std::string name = section.name.data();
      if (name == kept || !name.starts_with("level0/seen")) continue;
      section.name = {'o', 't', 'h', 'e', 'r'};
      write_at(bytes, entry_offset(i), section);
    }
    seal(bytes);
    const std::string message = refusal(bytes);
    INFO("said '" << message << "'");
    CHECK(message.find("found 'other', expected 'level0/seen") != std::string::npos);
  }
}

TEST_CASE("10,000 corruptions of what faces see behind valid checksums are refused or harmless") {
  const std::vector<std::byte> whole = graph_of(seeing_cube());
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < entries_present(whole); ++i) {
    const auto section = read_at<QgraphSection>(whole, entry_offset(i));
    if (!std::string(section.name.data()).starts_with("level0/seen")) continue;
    for (std::size_t at = 0; at < section.size; ++at) places.push_back(section.offset + at);
  }
  std::mt19937 random(2026);
  int taken = 0;
  for (int i = 0; i < 10000; ++i) {
    std::vector<std::byte> bytes = whole;
    for (std::size_t changes = 1 + random() % 4; changes > 0; --changes) {
      bytes[places[random() % places.size()]] = static_cast<std::byte>(random() % 20);
    }
    seal(bytes);
    try {
      const QuadGraph graph = QuadGraph::parse(bytes, "damaged.qgraph");
      REQUIRE(safe_to_use(graph.levels()[0]));
      ++taken;
    } catch (const FormatError&) {
    }
  }
  MESSAGE(taken << " of 10000 accepted");
  CHECK(taken > 0);
  CHECK(taken < 5000);
}
