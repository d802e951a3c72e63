// Where rays from the vertices begin.
#include "engine/reference/vertex_starts.h"

#include <doctest/doctest.h>

#include <glm/common.hpp>

#include "tests/cpp/fixtures/test_data.h"
#include "tests/cpp/fixtures/test_levels.h"

using namespace quadgraph;

namespace {

bool contains(const glm::uvec4& tet, std::uint32_t v) {
  return tet[0] == v || tet[1] == v || tet[2] == v || tet[3] == v;
}

// Whether a short step from vertex v along d stays in the tet.
bool points_into(const Level& level, std::uint32_t t, std::uint32_t v, const glm::dvec3& d) {
  const glm::uvec4& tet = level.tets[t];
  const glm::dvec3 p = glm::dvec3(level.vertices[v]) + 1e-3 * d;
  for (int k = 0; k < 4; ++k) {
    const glm::uvec3 face = face_of(tet, k);
    const glm::dvec3 a(level.vertices[face[0]]), b(level.vertices[face[1]]), c(level.vertices[face[2]]);
    if (glm::dot(glm::cross(b - a, c - a), p - a) > 1e-9) return false;
  }
  return true;
}

double distance(const Level& level, std::uint32_t a, std::uint32_t b) {
  return glm::distance(glm::dvec3(level.vertices[a]), glm::dvec3(level.vertices[b]));
}

}  // namespace

TEST_CASE("a vertex on the surface is its own way out, an inner one has the nearest") {
  const OwnedLevel owned = box_level(6, 6.0f, 0.2f);
  const Level level = owned.view();
  const VertexStarts starts = vertex_starts(level);
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    if (v < level.surface_vertex_count) {
      CHECK(starts.nearest[v] == v);
      continue;
    }
    double least = 1e30;
    for (std::uint32_t s = 0; s < level.surface_vertex_count; ++s) least = std::min(least, distance(level, v, s));
    CHECK(starts.nearest[v] < level.surface_vertex_count);
    CHECK(distance(level, v, starts.nearest[v]) == doctest::Approx(least));
  }
}

TEST_CASE("the start is a tet at the vertex, the one that the normal points into where there is one") {
  const OwnedLevel owned = box_level(5, 5.0f, 0.3f);
  const Level level = owned.view();
  const VertexStarts starts = vertex_starts(level);
  const auto normal = open_normals(level);
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    REQUIRE(contains(level.tets[starts.start[v]], v));
    const glm::dvec3 n = normal[starts.nearest[v]];
    CHECK(glm::length(n) == doctest::Approx(1));
    bool any = false;
    for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
      any = any || (contains(level.tets[t], v) && points_into(level, t, v, n));
    }
    CHECK(any == (v >= level.surface_vertex_count));
    CHECK(points_into(level, starts.start[v], v, n) == any);
  }
}

TEST_CASE("reflecting walls are no way out") {
  OwnedLevel owned = box_level(4, 4.0f);
  for (const glm::uvec3& f : owned.faces) {
    const float x = (owned.vertices[f.x].x + owned.vertices[f.y].x + owned.vertices[f.z].x) / 3;
    owned.face_kinds.push_back(x < 1e-5f ? face_open : face_reflecting);
  }
  const Level level = owned.view();
  const VertexStarts starts = vertex_starts(level);
  const auto normal = open_normals(level);
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    const glm::vec3 p = level.vertices[v], s = level.vertices[starts.nearest[v]];
    CHECK(s == glm::vec3(0, p.y, p.z));
    CHECK(glm::distance(normal[starts.nearest[v]], glm::dvec3(-1, 0, 0)) < 1e-12);
    CHECK(points_into(level, starts.start[v], v, {-1, 0, 0}) == (p.x > 0));
  }
  owned.face_kinds.assign(owned.faces.size(), face_reflecting);
  CHECK(vertex_starts(owned.view()).nearest.back() == level.vertex_count() - 1);
}

TEST_CASE("the nearest boundary is the surface or one that two bodies share") {
  const QuadGraph graph = QuadGraph::load(test_data("nested_cubes.qgraph"));
  const Level& level = graph.levels()[0];
  const std::vector<std::uint32_t> nearest = nearest_boundary(level);
  REQUIRE(nearest.size() == level.vertices.size());
  std::size_t shared = 0;
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    const glm::vec3 off = glm::abs(level.vertices[v] - glm::vec3(1.5f));
    const bool of_inner = off == glm::vec3(0.5f);
    shared += of_inner;
    if (of_inner || v < level.surface_vertex_count) CHECK(nearest[v] == v);
  }
  CHECK(shared == 8);
  CHECK(nearest_boundary(QuadGraph::load(test_data("two_cubes.qgraph")).levels()[0]).empty());
}

TEST_CASE("what a body's rays begin at is looked for in pieces, and given up between two") {
  const OwnedLevel owned = box_level(16, 16.0f);
  const Level level = owned.view();
  std::uint32_t calls = 0;
  const VertexStarts heard = vertex_starts(level, [&] { ++calls; });
  CHECK(calls >= level.tet_count() / 4096);
  CHECK(heard.start == vertex_starts(level).start);
  struct Enough {};
  CHECK_THROWS_AS(vertex_starts(level, [&] { throw Enough(); }), Enough);
}
