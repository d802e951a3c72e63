// What the faces see of each other, as stored: read as written, and every broken rule refused by its name.
#include <doctest/doctest.h>

#include <functional>
#include <random>
#include <string>

#include "engine/base/error.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"
#include "tests/cpp/fixtures/qgraph_bytes.h"

using namespace quadgraph;

namespace {

// Two slabs of 12 faces each across a gap; those at the gap see each other.
OwnedLevel seeing_slabs() {
  OwnedLevel level = facing_slabs(1, 1.0f, 0.5f, 0.25f);
  bake_seen(level, 16);
  return level;
}

// A row with different entries, and where it begins.
std::uint32_t seeing_row(const OwnedLevel& level) {
  for (std::uint32_t f = 0; f < level.faces.size(); ++f) {
    if (level.seen[f] < level.seen[f + 1] && level.seen[level.seen[f]] < level.seen[level.seen[f + 1] - 1]) return f;
  }
  return 0;
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
  OwnedLevel level = seeing_slabs();
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
  const OwnedLevel level = seeing_slabs();
  const QuadGraph graph = QuadGraph::parse(graph_of(level), "seen");
  const Level& read = graph.levels()[0];
  CHECK(read.seen_rays == 16);
  CHECK(read.seen.size() > 25);
  CHECK(std::vector<std::uint32_t>(read.seen.begin(), read.seen.end()) == level.seen);
  const QuadGraph plain = QuadGraph::parse(graph_of(split_at_centroids(box_level(1, 1.0f))), "plain");
  CHECK(plain.levels()[0].seen.empty());
  CHECK(plain.levels()[0].seen_rays == 0);
}

TEST_CASE("a body that sees nothing of itself has rows without entries") {
  OwnedLevel level = split_at_centroids(box_level(1, 1.0f));
  bake_seen(level, 16);
  CHECK(QuadGraph::parse(graph_of(level), "sky").levels()[0].seen.size() == 13);
}

TEST_CASE("broken rules of what faces see are named") {
  struct Case {
    std::function<void(OwnedLevel&)> change;
    std::string said;
  };
  const OwnedLevel good = seeing_slabs();
  const std::uint32_t f = seeing_row(good), begin = good.seen[f];
  const std::string row = "level0/seen: row " + std::to_string(f) + ": ", size = std::to_string(good.seen.size());
  REQUIRE(f > 0);
  const std::vector<Case> cases = {
      {[](auto& l) { l.seen_rays = 0; }, "level0/seen_rays: 0 found, 1 to 4096 allowed"},
      {[](auto& l) { l.seen_rays = 1000000; }, "level0/seen_rays: 1000000 found, 1 to 4096 allowed"},
      {[](auto& l) { l.seen_rays = 1; }, row + "13 entries, allowed are at most 1, the rays of a face"},
      {[](auto& l) { l.seen.resize(24); }, "level0/seen: 24 values, expected at least 25"},
      {[](auto& l) { l.seen[0] = 24; }, "level0/seen: row 0: must begin at 25"},
      {[](auto& l) { l.seen.push_back(1); }, "level0/seen: the last row ends at " + size},
      {[](auto& l) { l.seen[24] = 4000; }, "level0/seen: the last row ends at 4000, the section at " + size},
      {[f](auto& l) { l.seen[f + 1] = l.seen[f] - 1; }, row + "ends before it begins"},
      {[f](auto& l) { l.seen[f] = 4000000000u; }, "3999999975 entries, allowed are at most 16"},
      {[f](auto& l) { l.seen[l.seen[f + 1] - 1] = 24; }, row + "face 24, allowed is below 24"},
      {[f, begin](auto& l) { std::fill(&l.seen[begin], &l.seen[l.seen[f + 1]], f); },
       row + "a face does not see itself"},
      {[f](auto& l) { std::reverse(&l.seen[l.seen[f]], &l.seen[l.seen[f + 1]]); },
       row + "faces are not in ascending order"},
  };
  for (const Case& broken : cases) {
    const std::string message = refusal_after(broken.change);
    INFO("said '" << message << "', expected '" << broken.said << "'");
    CHECK(message.find(broken.said) != std::string::npos);
  }
}

TEST_CASE("rows that are not what their rays meet are refused") {
  const std::vector<std::function<void(OwnedLevel&)>> lies = {
      [](auto& l) { l.seen.assign(25, 25); },  // nothing
      [](auto& l) {                            // others' faces
        for (std::uint32_t f = 0; f < 24; ++f) std::fill(&l.seen[l.seen[f]], &l.seen[l.seen[f + 1]], (f + 1) % 24);
      },
      [](auto& l) { l.seen_rays = 4096; },
      [](auto& l) {  // the rows of other faces
        const OwnedLevel good = l;
        for (std::uint32_t f = 0; f < 24; ++f) l.seen[f] = l.seen[std::min(f + 1, 24u)];
        l.seen[0] = 25;
      },
  };
  for (const auto& lie : lies) {
    const std::string message = refusal_after(lie);
    INFO("said '" << message << "'");
    CHECK(message.find("rows meet other faces than are stored") != std::string::npos);
    CHECK(message.ends_with("; bake the body again"));
  }
}

TEST_CASE("a ray that grazes an edge may meet either face") {
  OwnedLevel level = seeing_slabs();
  const std::uint32_t f = seeing_row(level);
  level.seen[level.seen[f]] = level.seen[level.seen[f] + 1];
  CHECK(refusal(graph_of(level)).empty());
}

TEST_CASE("only one level may tell what its faces see") {
  const std::string message = refusal(graph_of({seeing_slabs(), seeing_slabs()}));
  INFO("said '" << message << "'");
  CHECK(message.find("level1/seen: only one level may have it") != std::string::npos);
}

TEST_CASE("rows of what faces see need the number of rays, and the number the rows") {
  for (const std::string kept : {"level0/seen", "level0/seen_rays"}) {
    std::vector<std::byte> bytes = graph_of(seeing_slabs());
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
  const std::vector<std::byte> whole = graph_of(seeing_slabs());
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
