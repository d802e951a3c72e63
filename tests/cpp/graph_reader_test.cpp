// The reader against damage: nothing but FormatError may come out of a file that breaks a rule.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>

#include "engine/graph/error.h"
#include "engine/graph/graph.h"
#include "tests/cpp/qgraph_checksums.h"

using namespace quadgraph;

namespace {

std::vector<std::byte> tiny_file() {
  std::ifstream stream(QUADGRAPH_TEST_DATA "/tiny.qgraph", std::ios::binary);
  REQUIRE(stream);
  std::vector<std::byte> bytes;
  std::transform(std::istreambuf_iterator<char>(stream), {}, std::back_inserter(bytes),
                 [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

bool refused(std::span<const std::byte> bytes) {
  try {
    QuadGraph::parse(bytes, "test");
    return false;
  } catch (const FormatError&) {
    return true;
  }
}

QgraphSection& section_named(std::vector<std::byte>& file, std::string_view name) {
  auto* header = reinterpret_cast<QgraphHeader*>(file.data());
  auto* table = reinterpret_cast<QgraphSection*>(file.data() + sizeof(QgraphHeader));
  for (std::uint32_t i = 0; i < header->section_count; ++i) {
    if (name == table[i].name.data()) return table[i];
  }
  FAIL("no such section");
  return *table;
}

// The message after `change` was made to a copy of the tiny file and all checksums were made right again.
template <typename Change>
std::string message_after(Change change) {
  std::vector<std::byte> file = tiny_file();
  change(file);
  fix_checksums(file);
  try {
    QuadGraph::parse(file, "test.qgraph");
  } catch (const FormatError& error) {
    return error.what();
  }
  return "accepted";
}

template <typename T>
auto set(const char* section, std::size_t index, T value) {
  return [=](std::vector<std::byte>& file) {
    std::memcpy(file.data() + section_named(file, section).offset + index * sizeof(T), &value, sizeof(T));
  };
}

}  // namespace

TEST_CASE("the tiny file has two levels that fit together") {
  const QuadGraph graph = QuadGraph::parse(tiny_file(), "tiny");
  REQUIRE(graph.levels().size() == 2);
  const Level& fine = graph.levels()[0];
  CHECK(fine.node_count() == fine.tet_count() + fine.face_count());
  CHECK(fine.surface_vertex_count <= fine.vertex_count());
  CHECK(fine.inner.width == 8);
  CHECK(graph.levels()[1].inner.width == 0);
  CHECK(reinterpret_cast<std::uintptr_t>(fine.vertices.data()) % qgraph_alignment == 0);
  CHECK(graph.metadata().front() == '{');
}

TEST_CASE("every truncated prefix and every extra byte is refused") {
  const std::vector<std::byte> file = tiny_file();
  for (std::size_t size = 0; size < file.size(); ++size) {
    CHECK_MESSAGE(refused({file.data(), size}), "prefix of ", size, " bytes was accepted");
  }
  std::vector<std::byte> longer = file;
  longer.push_back(std::byte{0});
  CHECK(refused(longer));
  longer.resize(file.size() + qgraph_alignment);
  CHECK(refused(longer));
}

TEST_CASE("10,000 random single-bit and single-byte damages are all refused") {
  const std::vector<std::byte> file = tiny_file();
  std::mt19937 random(1);
  for (int trial = 0; trial < 10000; ++trial) {
    std::vector<std::byte> damaged = file;
    const std::size_t at = random() % file.size();
    const auto mask = static_cast<std::byte>(trial % 2 == 0 ? 1u << random() % 8 : 1u + random() % 255);
    damaged[at] ^= mask;
    CHECK_MESSAGE(refused(damaged), "damage at byte ", at, " was accepted");
  }
}

TEST_CASE("10,000 random damages with right checksums end in FormatError or in a graph that can be walked") {
  const std::vector<std::byte> file = tiny_file();
  std::mt19937 random(2);
  int accepted = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    std::vector<std::byte> damaged = file;
    for (std::uint32_t k = 0; k < 1 + random() % 4; ++k) {
      damaged[random() % file.size()] = static_cast<std::byte>(random());
    }
    fix_checksums(damaged);
    try {
      const QuadGraph graph = QuadGraph::parse(damaged, "damaged");
      ++accepted;  // a changed coordinate or weight may still be legal
      for (const Level& level : graph.levels()) {
        for (const glm::uvec4& link : level.links) CHECK(link[0] < level.node_count());
      }
    } catch (const FormatError&) {
    }
  }
  MESSAGE("accepted ", accepted, " of 10000");
  CHECK(accepted < 9000);
}

TEST_CASE("each rule has a message that names file, section and what is allowed") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(message_after([](auto&) {}) == "accepted");
  CHECK(
      message_after(set<std::uint32_t>("level0/tets", 3, 4000000000u)).find("test.qgraph: level0/tets: row 0: index") ==
      0);
  CHECK(message_after(set("level0/vertices", 0, nan)).find("level0/vertices: row 0: a value is not finite") !=
        std::string::npos);
  CHECK(message_after(set("level0/inner_weight", 0, -1.0f)).find("level0/inner_weight: row 0") != std::string::npos);
  CHECK(message_after(set("level0/surface_weight", 0, 0.9f)).find("weights sum to") != std::string::npos);
  CHECK(message_after(set<std::uint32_t>("level0/links", 0, 1u)) != "accepted");
  CHECK(message_after(set<std::uint32_t>("level1/face_tets", 0, 7u)) != "accepted");
  CHECK(message_after(set("display/normals", 0, 3.0f)).find("unit length") != std::string::npos);
  CHECK(message_after(set("metadata", 0, '[')).find("metadata") != std::string::npos);
}

TEST_CASE("inverted tets and swapped faces are refused") {
  const auto swap_u32 = [](const char* section, std::size_t a, std::size_t b) {
    return [=](std::vector<std::byte>& file) {
      auto* values = reinterpret_cast<std::uint32_t*>(file.data() + section_named(file, section).offset);
      std::swap(values[a], values[b]);
    };
  };
  CHECK(message_after(swap_u32("level0/tets", 0, 1)).find("positively oriented") != std::string::npos);
  CHECK(message_after(swap_u32("level0/faces", 0, 1)).find("level0/faces") != std::string::npos);
}

TEST_CASE("sizes that would overflow or reach outside are refused before anything is read") {
  const auto change_entry = [](auto change) {
    return message_after([=](std::vector<std::byte>& file) { change(section_named(file, "level0/tets")); });
  };
  CHECK(change_entry([](QgraphSection& s) { s.shape[0] = std::uint64_t{1} << 62; }) != "accepted");
  CHECK(change_entry([](QgraphSection& s) { s.offset = ~std::uint64_t{63}; }) != "accepted");
  CHECK(change_entry([](QgraphSection& s) { s.size = ~std::uint64_t{0}; }) != "accepted");
  CHECK(change_entry([](QgraphSection& s) { s.rank = 3; }) != "accepted");
  CHECK(change_entry([](QgraphSection& s) { s.type = static_cast<SectionType>(9); }) != "accepted");
  CHECK(change_entry([](QgraphSection& s) { s.name[0] = 'L'; }) != "accepted");
}

TEST_CASE("a file that is not there is an input error that names it") {
  CHECK_THROWS_WITH_AS(QuadGraph::load("nowhere.qgraph"), doctest::Contains("nowhere.qgraph"), InputError);
}
