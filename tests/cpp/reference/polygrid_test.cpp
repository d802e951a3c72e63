// The links of polygrids: what the reader refuses, what the rows made of them do.
#include "engine/file/polygrid.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "engine/base/error.h"
#include "tests/cpp/fixtures/graph_cases.h"
#include "tests/cpp/fixtures/qgraph_bytes.h"
#include "tests/cpp/fixtures/test_data.h"

using namespace quadgraph;

namespace {

const std::filesystem::path grid_path = test_data("polygrid.qgraph");
constexpr std::array<Method, 2> grid_methods = {Method::polygrid, Method::polygrid_divergence};

using Links = std::vector<std::uint32_t>;

// The refusal after `change` was made to the links of the finest level; else the file goes to `taken`.
std::string refusal(const std::function<void(Links&, const Level&)>& change,
                    std::optional<QuadGraph>* taken = nullptr) {
  std::vector<std::byte> bytes(std::filesystem::file_size(grid_path));
  std::ifstream(grid_path, std::ios::binary)
      .read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const QuadGraph whole = QuadGraph::parse(bytes, "whole");
  for (std::size_t i = 0; i < entries_present(bytes); ++i) {
    const auto section = read_at<QgraphSection>(bytes, entry_offset(i));
    if (std::string(section.name.data()) != "level0/grid_links") continue;
    Links links(section.size / sizeof(std::uint32_t));
    std::memcpy(links.data(), bytes.data() + section.offset, section.size);
    change(links, whole.levels()[0]);
    std::memcpy(bytes.data() + section.offset, links.data(), section.size);
  }
  seal(bytes);
  try {
    QuadGraph graph = QuadGraph::parse(bytes, "test.qgraph");
    if (taken != nullptr) taken->emplace(std::move(graph));
  } catch (const FormatError& error) {
    return error.what();
  }
  return {};
}

void check_says(const std::string& message, const std::string& part) {
  INFO("said '" << message << "'");
  CHECK(message.find("level0/grid_links") != std::string::npos);
  CHECK(message.find(part) != std::string::npos);
}

}  // namespace

TEST_CASE("links of a polygrid that break a rule are refused") {
  CHECK(refusal([](Links&, const Level&) {}).empty());
  check_says(refusal([](Links& links, const Level& level) { links[7] = level.vertex_count(); }), "allowed is below");
  check_says(refusal([](Links& links, const Level& level) { links[0] = level.surface_vertex_count; }),
             "linked to itself");
  const auto first_outside = [](Links& links, const Level& level) {
    return std::find_if(links.begin(), links.end(), [&](std::uint32_t v) { return v < level.surface_vertex_count; });
  };
  check_says(refusal([&](Links& links, const Level& level) {
               const auto outside = first_outside(links, level);
               *first_outside(links, level) = *outside == 0 ? 1 : 0;
             }),
             "a second time");
  check_says(
      refusal([&](Links& links, const Level& level) { *first_outside(links, level) = level.vertex_count() - 1; }),
      "is not linked");
  // All links of the last vertex lead to itself and its own neighbours: it hangs on nothing if these hang on it.
  check_says(refusal([](Links& links, const Level& level) {
               const std::uint32_t first = level.surface_vertex_count, last = level.vertex_count() - 1;
               for (std::uint32_t k = 0; k < grid_link_count; ++k) {
                 links[grid_link_count * (last - first) + k] = last - 1;
                 links[grid_link_count * (last - 1 - first) + k] = last;
               }
             }),
             "not linked to the surface");
}

TEST_CASE("random links are refused or harmless") {
  const QuadGraph whole = QuadGraph::load(grid_path);
  const Level& level = whole.levels()[0];
  std::mt19937 random(2008);
  int accepted = 0;
  for (int i = 0; i < 300; ++i) {
    const auto damage = [&](Links& links, const Level&) {
      links[random() % links.size()] = static_cast<std::uint32_t>(random() % (level.vertex_count() + 2));
    };
    std::optional<QuadGraph> graph;
    if (!refusal(damage, &graph).empty()) continue;
    ++accepted;
    const Level& changed = graph->levels()[0];
    const Opticals optical = uniform(changed, 0.3f, 0.01f);
    const auto q = everywhere(changed, glm::vec3(1));
    SolveOptions options = solving(Method::polygrid, Source::buried, Model::diffusion);
    options.max_iterations = 3;
    const ReferenceSolution solution = solve_reference(changed, optical, 1.3, lambertian(q), options);
    for (const glm::dvec3& phi : solution.phi) CHECK(std::isfinite(phi.x));
  }
  CHECK(accepted > 0);
  CHECK(accepted < 300);
}

TEST_CASE("layers ascend from the surface, and its vertices have one neighbour") {
  const QuadGraph graph = QuadGraph::load(grid_path);
  for (const Level& level : graph.levels()) {
    const std::vector<std::uint32_t> layers = grid_layers(level), neighbours = grid_neighbours(level);
    CHECK(std::is_sorted(layers.begin(), layers.end()));
    CHECK(layers[level.surface_vertex_count - 1] == 0);
    CHECK(layers[level.surface_vertex_count] == 1);
    for (std::uint32_t s = 0; s < level.surface_vertex_count; ++s) {
      REQUIRE(neighbours[s] >= level.surface_vertex_count);
      CHECK(layers[neighbours[s]] == 1);
      std::uint32_t found = 0;
      for (std::uint32_t k = 0; k < grid_link_count; ++k) found += level.grid_link(neighbours[s], k) == s ? 1 : 0;
      CHECK(found == 1);
    }
  }
}

TEST_CASE("rows of polygrids have positive diagonals, no positive entries, and sums of absorption and surface alone") {
  const QuadGraph graph = QuadGraph::load(grid_path);
  for (const Level& level : graph.levels()) {
    const Opticals optical = varying(level, 0.0f);
    const Problem problem{Method::polygrid_divergence, Source::buried, Model::diffusion, optical, 1.3};
    const Rows rows = assemble(level, problem);
    for (std::uint32_t i = 0; i < rows.size(); ++i) {
      glm::dvec3 sum = rows.diagonal[i].a11;
      for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
        for (int c = 0; c < 3; ++c) CHECK(rows.weight[k].a11[c] < 0);
        if (k > rows.offset[i]) CHECK(rows.column[k] > rows.column[k - 1]);
        sum += rows.weight[k].a11;
      }
      const glm::dvec3 share = sum / rows.diagonal[i].a11;
      for (int c = 0; c < 3; ++c) {
        if (i < level.surface_vertex_count) CHECK(share[c] > 1e-6);
        if (i >= level.surface_vertex_count) CHECK(std::abs(share[c]) < 1e-12);
      }
    }
  }
}

TEST_CASE(
    "a uniform fluence is a solution of both methods in uniform light, of the divergence form where kappa varies") {
  const QuadGraph graph = QuadGraph::load(grid_path);
  const Level& level = graph.levels()[0];
  const auto q = everywhere(level, glm::vec3(0.7f));
  for (Method method : grid_methods) {
    for (Model model : both_models) {
      CAPTURE(name_of(method));
      const Opticals optical = method == Method::polygrid ? uniform(level, 0.3f, 0.0f) : varying(level, 0.0f);
      const ReferenceSolution solution =
          solve_reference(level, optical, 1.3, lambertian(q), solving(method, Source::diffuse, model));
      for (const glm::dvec3& m : solution.exitance) {
        for (int c = 0; c < 3; ++c) CHECK(m[c] == doctest::Approx(0.7).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("a file without a polygrid is refused by the methods that need one") {
  const OwnedLevel box = box_level(2, 2.0f);
  const Level level = box.view();
  const Opticals optical = uniform(level, 0.3f, 0.0f);
  for (Method method : grid_methods) {
    CHECK_THROWS_WITH_AS(assemble(level, {method, Source::buried, Model::diffusion, optical, 1.3}),
                         doctest::Contains("--mesher polygrid"), InputError);
  }
  CHECK(methods_of(level).size() == 3);
  CHECK(methods_of(QuadGraph::load(grid_path).levels()[0]).size() == 5);
}
