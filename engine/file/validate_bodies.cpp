// The rules of files that hold several bodies.
#include <algorithm>
#include <vector>

#include "engine/file/body_names.h"
#include "engine/file/section_table.h"
#include "engine/file/validate.h"

namespace quadgraph {
namespace {

std::string of_level(std::size_t index, const char* section) {
  return "level" + std::to_string(index) + "/" + section;
}

void check_level(const Level& level, std::size_t bodies, const std::string& file, std::size_t index) {
  const std::string section = of_level(index, "tet_bodies");
  if (level.tet_bodies.empty() != (bodies == 0)) {
    fail_format(file, section, bodies == 0 ? "found without 'bodies' in the metadata" : "the section is missing");
  }
  if (bodies == 0) return;
  if (level.tet_bodies.size() != level.tets.size()) {
    fail_format(file, section,
                std::to_string(level.tet_bodies.size()) + " rows, expected " + std::to_string(level.tets.size()));
  }
  std::vector<bool> present(bodies, false);
  for (std::size_t t = 0; t < level.tet_bodies.size(); ++t) {
    const std::size_t body = level.tet_bodies[t];
    if (body >= bodies) {
      fail_format(file, section,
                  "row " + std::to_string(t) + ": index " + std::to_string(body) + ", allowed is below " +
                      std::to_string(bodies));
    }
    present[body] = true;
  }
  const auto missing = std::ranges::find(present, false);
  if (missing != present.end()) {
    fail_format(file, section, "body " + std::to_string(missing - present.begin()) + " has no tet");
  }
}

// Which bodies lie within which.
struct Nesting {
  const std::vector<std::uint32_t>& hosts;  // as body_hosts
  std::vector<std::uint32_t> outermost;

  std::uint32_t around(std::uint32_t body) const { return outermost[body]; }
  bool touch(std::uint32_t a, std::uint32_t b) const { return hosts[a] == b || hosts[b] == a; }
};

// The outermost body around each vertex, which no two such share where links do not join them.
std::vector<std::uint32_t> bodies_of_vertices(const Level& level, const Nesting& nesting, const std::string& file,
                                              std::size_t index) {
  std::vector<std::uint32_t> body(level.vertices.size(), 0);
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    for (int k = 0; k < 4; ++k) body[level.tets[t][k]] = nesting.around(level.tet_bodies[t]);
  }
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    const std::uint32_t own = level.tet_bodies[t];
    for (int k = 0; k < 4; ++k) {
      const char* wrong = nullptr;
      if (body[level.tets[t][k]] != nesting.around(own)) {
        wrong = "shares a vertex with another body";
      } else if (level.tets[t][k] < level.surface_vertex_count && own != nesting.around(own)) {
        wrong = "of a body within another, has a vertex on the surface";
      }
      if (wrong) fail_format(file, of_level(index, "tets"), "row " + std::to_string(t) + ": " + wrong);
    }
  }
  return body;
}

void check_links(const Level& level, const Nesting& nesting, const std::string& file, std::size_t index) {
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t other = level.links[t][k];
      if (other >= level.tets.size() || level.tet_bodies[other] == level.tet_bodies[t]) continue;
      if (nesting.touch(level.tet_bodies[other], level.tet_bodies[t])) continue;
      fail_format(file, of_level(index, "links"), "row " + std::to_string(t) + ": a link joins two bodies");
    }
  }
}

// own, other: the body of row r of the finer level, of row r of the coarser one.
template <typename Own, typename Other>
void check_transfer(const Transfer& transfer, const Own& own, const Other& other, const std::string& file,
                    const std::string& section) {
  for (std::size_t i = 0; i < transfer.index.size(); ++i) {
    const std::size_t row = i / transfer.width;
    if (own(row) == other(transfer.index[i])) continue;
    fail_format(file, section, "row " + std::to_string(row) + ": takes from another body");
  }
}

auto by_tet(const Level& level, const Nesting& nesting) {
  return [&](std::size_t t) { return nesting.around(level.body_of_tet(static_cast<std::uint32_t>(t))); };
}

auto by_face(const Level& level) {
  return [&level](std::size_t f) { return level.body_of_face(static_cast<std::uint32_t>(f)); };
}

}  // namespace

void validate_bodies(std::span<const Level> levels, std::size_t bodies, const std::string& file) {
  if (levels.empty() && bodies > 0) fail_format(file, "metadata", "'bodies' found in a file without levels");
  for (std::size_t i = 0; i < levels.size(); ++i) check_level(levels[i], bodies, file, i);
}

void validate_bodies_apart(std::span<const Level> levels, const DisplayMesh& display,
                           const std::vector<std::uint32_t>& hosts, const std::string& file) {
  if (levels.empty() || levels[0].tet_bodies.empty()) return;
  const Nesting nesting{hosts, outermost_bodies(hosts)};
  std::vector<std::vector<std::uint32_t>> vertices;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    check_links(levels[i], nesting, file, i);
    vertices.push_back(bodies_of_vertices(levels[i], nesting, file, i));
  }
  for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
    const Level &fine = levels[i], &coarse = levels[i + 1];
    check_transfer(fine.inner, by_tet(fine, nesting), by_tet(coarse, nesting), file, of_level(i, "inner_index"));
    check_transfer(fine.surface, by_face(fine), by_face(coarse), file, of_level(i, "surface_index"));
    const auto fine_vertex = [&](std::size_t v) { return vertices[i][v]; };
    const auto coarse_vertex = [&](std::size_t v) { return vertices[i + 1][v]; };
    check_transfer(fine.barycentric, fine_vertex, coarse_vertex, file, of_level(i, "barycentric_index"));
  }
  for (std::size_t t = 0; t < display.triangles.size(); ++t) {
    const auto body = [&](int k) { return levels[0].body_of_face(display.face[display.triangles[t][k]]); };
    if (body(0) == body(1) && body(0) == body(2)) continue;
    fail_format(file, "display/triangles", "row " + std::to_string(t) + ": joins two bodies");
  }
}

}  // namespace quadgraph
