// The reader's rules one by one: what is broken is refused by section and rule.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>

#include "engine/base/error.h"
#include "engine/file/graph.h"
#include "tests/cpp/fixtures/qgraph_bytes.h"
#include "tests/cpp/fixtures/test_data.h"
#include "tests/cpp/fixtures/test_graphs.h"

using namespace quadgraph;

namespace {

using Bytes = std::vector<std::byte>;

const std::filesystem::path tiny_path = test_data("tiny.qgraph");

// The message of the refusal; empty if the file is accepted.
std::string refusal(std::span<const std::byte> bytes) {
  try {
    QuadGraph::parse(bytes, "test.qgraph");
  } catch (const FormatError& error) {
    return error.what();
  }
  return {};
}

std::string refusal_sealed(Bytes bytes) {
  seal(bytes);
  return refusal(bytes);
}

struct Found {
  std::size_t entry;  // byte offset in the table
  QgraphSection section;
};

Found find(const Bytes& bytes, const std::string& name) {
  for (std::size_t i = 0; i < entries_present(bytes); ++i) {
    const auto section = read_at<QgraphSection>(bytes, entry_offset(i));
    if (name == section.name.data()) return {entry_offset(i), section};
  }
  FAIL("no section " << name);
  return {};
}

// The refusal after `change` was made to the data of a section that otherwise is whole.
template <typename T>
std::string refusal_of_data(const std::string& name, const std::function<void(std::vector<T>&)>& change) {
  Bytes bytes = tiny_bytes();
  const Found found = find(bytes, name);
  std::vector<T> values(found.section.size / sizeof(T));
  std::memcpy(values.data(), bytes.data() + found.section.offset, found.section.size);
  change(values);
  std::memcpy(bytes.data() + found.section.offset, values.data(), found.section.size);
  return refusal_sealed(bytes);
}

std::string refusal_of_entry(const std::string& name, const std::function<void(QgraphSection&)>& change) {
  Bytes bytes = tiny_bytes();
  Found found = find(bytes, name);
  change(found.section);
  write_at(bytes, found.entry, found.section);
  return refusal_sealed(bytes);
}

template <typename Field>
std::string refusal_of_header(Field QgraphHeader::* field, Field value) {
  Bytes bytes = tiny_bytes();
  auto header = read_at<QgraphHeader>(bytes, 0);
  header.*field = value;
  write_at(bytes, 0, header);
  return refusal(bytes);
}

void check_says(const std::string& message, std::initializer_list<std::string> parts) {
  for (const std::string& part : parts) {
    INFO("said '" << message << "', should contain '" << part << "'");
    CHECK(message.find(part) != std::string::npos);
  }
}

}  // namespace

TEST_CASE("the golden file loads, from disk as from memory") {
  const QuadGraph graph = QuadGraph::load(tiny_path);
  REQUIRE(graph.levels().size() == 2);
  CHECK(graph.levels()[0].inner.width == 8);
  CHECK(graph.levels()[1].inner.width == 0);
  for (const Level& level : graph.levels()) {
    double volume = 0;
    for (const glm::uvec4& t : level.tets) {
      const glm::dvec3 p(level.vertices[t[0]]);
      volume += glm::dot(glm::dvec3(level.vertices[t[1]]) - p,
                         glm::cross(glm::dvec3(level.vertices[t[2]]) - p, glm::dvec3(level.vertices[t[3]]) - p)) /
                6.0;
    }
    CHECK(volume == doctest::Approx(8.0).epsilon(1e-6));  // a cube of 2 mm
  }
  CHECK(reinterpret_cast<std::uintptr_t>(graph.levels()[0].vertices.data()) % qgraph_alignment == 0);
  const Bytes bytes = tiny_bytes();
  const QuadGraph parsed = QuadGraph::parse(bytes, "memory");
  CHECK(parsed.byte_size() == bytes.size());
  CHECK(parsed.metadata() == graph.metadata());
}

TEST_CASE("what cannot be read is an input error that names the path") {
  CHECK_THROWS_WITH_AS(QuadGraph::load("/nowhere/a.qgraph"), doctest::Contains("/nowhere/a.qgraph"), InputError);
  CHECK_THROWS_WITH_AS(QuadGraph::load(test_data()), doctest::Contains(test_data().c_str()), InputError);
}

TEST_CASE("a huge file that is none of ours is refused without being read") {
  const auto path = std::filesystem::temp_directory_path() / ("quadgraph-sparse-" + std::to_string(::getpid()));
  std::ofstream(path).put('x');
  std::filesystem::resize_file(path, std::uintmax_t{1} << 40);
  CHECK_THROWS_WITH_AS(QuadGraph::load(path), doctest::Contains("magic"), FormatError);
  std::filesystem::remove(path);
}

TEST_CASE("header fields are checked") {
  check_says(refusal({}), {"test.qgraph", "header"});
  check_says(refusal_of_header(&QgraphHeader::version, 2u), {"header", "version 2", "reads version 1"});
  check_says(refusal_of_header(&QgraphHeader::byte_order, 0x04030201u), {"header", "byte_order"});
  check_says(refusal_of_header(&QgraphHeader::file_size, ~std::uint64_t{0}), {"header", "file_size"});
  for (const std::uint32_t count : {0u, 4097u, ~0u}) {
    check_says(refusal_of_header(&QgraphHeader::section_count, count), {"section_count " + std::to_string(count)});
  }
  check_says(refusal_of_header(&QgraphHeader::reserved, {1}), {"header", "reserved"});
  check_says(refusal_of_header(&QgraphHeader::magic, {'P', 'K'}), {"header", "magic"});
}

TEST_CASE("table entries are checked before their sizes are believed") {
  const std::string name = "level0/tets";
  const auto say = [&](const std::function<void(QgraphSection&)>& change) { return refusal_of_entry(name, change); };
  check_says(say([](auto& s) { s.type = static_cast<SectionType>(4); }), {name, "type"});
  check_says(say([](auto& s) { s.type = SectionType::f32; }), {name, "type"});
  check_says(say([](auto& s) { s.rank = 3; }), {name, "rank"});
  check_says(say([](auto& s) { s.rank = 1; }), {name, "shape"});
  check_says(say([](auto& s) { s.shape[0] = 0; }), {name, "shape"});
  check_says(say([](auto& s) { s.shape[2] = 1; }), {name, "shape"});
  check_says(say([](auto& s) { s.shape[0] += 1; }), {name, "size"});
  check_says(say([](auto& s) { s.offset += 64; }), {name, "offset"});
  check_says(say([](auto& s) { s.reserved[5] = 1; }), {name, "reserved"});
  check_says(say([](auto& s) { s.name.fill('x'); }), {"section", "name"});
  check_says(say([](auto& s) { s.name[0] = '\x07'; }), {"section", "name"});
  check_says(say([](auto& s) { s.name[40] = 'x'; }), {"section", "name"});
  check_says(say([](auto& s) { s.name[0] = 'L'; }), {name, "expected 'level0/tets'"});
  check_says(say([](auto& s) { s.name[5] = '1'; }), {"level1/tets", "twice"});
  // Products that wrap round to the true size must not pass.
  check_says(say([](auto& s) { s.shape[0] += std::uint64_t{1} << 60; }), {name, "shape"});
  check_says(say([](auto& s) { s.shape[0] = s.shape[1] = std::uint64_t{1} << 32; }), {name, "shape"});
  check_says(say([](auto& s) { s.size = s.shape[0] = ~std::uint64_t{0}; }), {name, "shape"});
}

TEST_CASE("nothing may follow, precede or fill the sections") {
  Bytes longer = tiny_bytes();
  longer.push_back(std::byte{0});
  check_says(refusal_sealed(longer), {"trailing"});
  longer.pop_back();
  longer.resize(longer.size() + qgraph_alignment);
  check_says(refusal(longer), {"file_size"});
  check_says(refusal_sealed(longer), {"trailing"});
  Bytes padded = tiny_bytes();
  const QgraphSection metadata = find(padded, "metadata").section;
  REQUIRE((metadata.offset + metadata.size) % qgraph_alignment != 0);
  padded[metadata.offset + metadata.size] = std::byte{1};
  check_says(refusal_sealed(padded), {"padding"});
}

TEST_CASE("an index out of range is refused in every section that holds indices") {
  const Bytes bytes = tiny_bytes();
  int tested = 0;
  for (std::size_t i = 0; i < entries_present(bytes); ++i) {
    const auto section = read_at<QgraphSection>(bytes, entry_offset(i));
    if (section.type != SectionType::u32) continue;
    const std::string name = section.name.data();
    for (const std::uint32_t index : {~0u, 0x80000000u, 1000u}) {
      const auto set_last = [&](std::vector<std::uint32_t>& v) { v.back() = index; };
      check_says(refusal_of_data<std::uint32_t>(name, set_last), {name});
    }
    ++tested;
  }
  CHECK(tested == 4 + 4 + 3 + 2);
}

TEST_CASE("a number that is not finite is refused in every section that holds numbers") {
  const Bytes bytes = tiny_bytes();
  int tested = 0;
  for (std::size_t i = 0; i < entries_present(bytes); ++i) {
    const auto section = read_at<QgraphSection>(bytes, entry_offset(i));
    if (section.type != SectionType::f32) continue;
    const std::string name = section.name.data();
    for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
      check_says(refusal_of_data<float>(name, [&](std::vector<float>& v) { v.back() = value; }), {name});
    }
    ++tested;
  }
  CHECK(tested == 2 + 2 + 3 + 3);
}

TEST_CASE("weights are non-negative and sum to one") {
  for (const std::string name : {"level0/inner_weight", "level0/surface_weight", "level0/barycentric_weight"}) {
    const auto negative = [](std::vector<float>& w) { w[0] -= 2.0f, w[1] += 2.0f; };
    check_says(refusal_of_data<float>(name, negative), {name, "negative"});
    check_says(refusal_of_data<float>(name, [](std::vector<float>& w) { w[0] += 3e-5f; }), {name, "sum"});
    CHECK(refusal_of_data<float>(name, [](std::vector<float>& w) { w[0] += 5e-6f; }).empty());
  }
}

TEST_CASE("tets are positive; faces may be rotated but not turned over") {
  using U = std::vector<std::uint32_t>;
  check_says(refusal_of_data<std::uint32_t>("level0/tets", [](U& t) { std::swap(t[0], t[1]); }), {"tets", "oriented"});
  check_says(refusal_of_data<std::uint32_t>("level0/tets", [](U& t) { t[0] = t[1]; }), {"tets", "oriented"});
  const auto rotate = [](U& f) { std::rotate(f.begin(), f.begin() + 1, f.begin() + 3); };
  // One that no vertex of the display mesh is placed in by its corners.
  CHECK(refusal_of_data<std::uint32_t>("level1/faces", rotate).empty());
  check_says(refusal_of_data<std::uint32_t>("level0/faces", [](U& f) { std::swap(f[0], f[1]); }), {"faces", "outward"});
}

TEST_CASE("links are symmetric and surface nodes have one") {
  using U = std::vector<std::uint32_t>;
  const QuadGraph graph = QuadGraph::load(tiny_path);
  const std::uint32_t n_t = graph.levels()[0].tet_count();
  const auto link_itself = [&](U& links) {
    *std::find_if(links.begin(), links.begin() + 4, [&](std::uint32_t j) { return j < n_t; }) = 0;
  };
  check_says(refusal_of_data<std::uint32_t>("level0/links", link_itself), {"level0/links", "back"});
  const auto swap_neighbours = [&](U& links) {
    const auto inner = [&](std::uint32_t j) { return j < n_t; };
    const auto first = std::find_if(links.begin(), links.begin() + 4, inner);
    const auto second = std::find_if(first + 1, links.begin() + 4, inner);
    REQUIRE(*first != *second);
    std::swap(*first, *second);
  };
  check_says(refusal_of_data<std::uint32_t>("level0/links", swap_neighbours), {"level0/links", "same face"});
  const auto next_tet = [&](U& tets) { tets[0] = (tets[0] + 1) % n_t; };
  check_says(refusal_of_data<std::uint32_t>("level0/face_tets", next_tet), {"face_tets"});
}

TEST_CASE("display normals have unit length") {
  const auto stretch = [](std::vector<float>& n) { n[0] += 2.0f; };
  check_says(refusal_of_data<float>("display/normals", stretch), {"display/normals", "unit length"});
}

TEST_CASE("a vertex without a tet is refused") {
  OwnedLevel level = split_at_centroids(box_level(1, 1.0f));
  const auto bytes_of = [](const OwnedLevel& l) {
    const Bytes whole = box_graph({1}, 1.0f);
    GraphWriter writer;
    for (std::size_t i = 0; i < entries_present(whole); ++i) {
      const auto section = read_at<QgraphSection>(whole, entry_offset(i));
      const std::string name = section.name.data();
      if (name == "level0/vertices") {
        writer.add_vectors(name, SectionType::f32, l.vertices);
      } else {
        writer.add<std::byte>(name, section.type, {section.shape.begin(), section.shape.begin() + section.rank},
                              std::span(whole).subspan(section.offset, section.size));
      }
    }
    return writer.bytes();
  };
  CHECK(refusal(bytes_of(level)).empty());
  level.vertices.push_back(glm::vec3(0.5f));
  check_says(refusal(bytes_of(level)), {"level0/vertices", "no tet"});
}

TEST_CASE("metadata is a JSON object in UTF-8") {
  for (const std::string text : {"[]", "null", "{", "{\"a\": 1e999}", "{\"\xff\": 1}", "{} {}"}) {
    const auto put = [&](std::vector<char>& v) {
      std::fill(v.begin(), v.end(), ' ');
      std::copy(text.begin(), text.end(), v.begin());
    };
    INFO(text);
    check_says(refusal_of_data<char>("metadata", put), {"metadata", "JSON"});
  }
  check_says(refusal_of_data<char>("metadata", [](auto& v) { std::fill(v.begin(), v.end(), '['); }), {"metadata"});
}

TEST_CASE("metadata tells what the document asks for") {
  for (const std::string key : {"generator", "unit_mm", "tools"}) {
    const auto rename = [&](std::vector<char>& v) {
      const std::string quoted = "\"" + key + "\"";
      *(std::search(v.begin(), v.end(), quoted.begin(), quoted.end()) + 1) = 'X';
    };
    check_says(refusal_of_data<char>("metadata", rename), {"metadata", key, "missing"});
  }
}

TEST_CASE("sections stand in the order of the document") {
  Bytes bytes = tiny_bytes();
  const Found a = find(bytes, "level0/tets"), b = find(bytes, "level0/links");
  QgraphSection renamed = a.section;
  renamed.name = b.section.name;
  write_at(bytes, a.entry, renamed);
  renamed = b.section;
  renamed.name = a.section.name;
  write_at(bytes, b.entry, renamed);
  check_says(refusal_sealed(bytes), {"section 2", "found 'level0/links'", "expected 'level0/tets'"});
}

TEST_CASE("kinds of faces are optional; unknown kinds and a wrong number of them are refused") {
  OwnedLevel level = split_at_centroids(box_level(1, 1.0f));
  CHECK_FALSE(QuadGraph::parse(graph_of(level), "open").levels()[0].reflecting(0));
  level.face_kinds.assign(level.faces.size(), face_open);
  level.face_kinds[1] = face_reflecting;
  const QuadGraph graph = QuadGraph::parse(graph_of(level), "walls");
  CHECK_FALSE(graph.levels()[0].reflecting(0));
  CHECK(graph.levels()[0].reflecting(1));
  level.face_kinds[2] = 2;
  CHECK_THROWS_WITH_AS(QuadGraph::parse(graph_of(level), "kind"), doctest::Contains("face_kinds"), FormatError);
  level.face_kinds.assign(3, face_open);
  CHECK_THROWS_WITH_AS(QuadGraph::parse(graph_of(level), "rows"), doctest::Contains("face_kinds"), FormatError);
}
