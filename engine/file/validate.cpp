#include "engine/file/validate.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "engine/file/geometry.h"
#include "engine/file/section_table.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t max_nodes = std::uint64_t{1} << 31;
constexpr double weight_sum_tolerance = 1e-5;

// Where a message points: file and level prefix.
struct Place {
  const std::string& file;
  std::string prefix;

  [[noreturn]] void fail(const std::string& section, const std::string& rule) const {
    fail_format(file, prefix + section, rule);
  }
  [[noreturn]] void fail(const std::string& section, std::size_t row, const std::string& rule) const {
    fail(section, "row " + std::to_string(row) + ": " + rule);
  }
};

void expect_rows(const Place& place, const std::string& section, std::size_t found, std::size_t expected) {
  if (found != expected) {
    place.fail(section, std::to_string(found) + " rows, expected " + std::to_string(expected));
  }
}

template <typename Vector>
void check_finite(const Place& place, const std::string& section, std::span<const Vector> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (int c = 0; c < Vector::length(); ++c) {
      if (!std::isfinite(values[i][c])) place.fail(section, i, "a value is not finite");
    }
  }
}

void check_index(const Place& place, const std::string& section, std::size_t row, std::size_t index,
                 std::size_t limit) {
  if (index < limit) return;
  place.fail(section, row, "index " + std::to_string(index) + ", allowed is below " + std::to_string(limit));
}

template <typename Vector>
void check_indices(const Place& place, const std::string& section, std::span<const Vector> values, std::size_t limit) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (int c = 0; c < Vector::length(); ++c) check_index(place, section, i, values[i][c], limit);
  }
}

void check_weights(const Place& place, const std::string& section, std::span<const float> weights,
                   std::uint32_t width) {
  for (std::size_t row = 0; row * width < weights.size(); ++row) {
    double sum = 0;
    for (std::uint32_t k = 0; k < width; ++k) {
      const float w = weights[row * width + k];
      if (!(w >= 0 && std::isfinite(w))) place.fail(section, row, "a weight is negative or not finite");
      sum += w;
    }
    if (std::abs(sum - 1.0) > weight_sum_tolerance) {
      place.fail(section, row, "weights sum to " + std::to_string(sum) + ", expected 1");
    }
  }
}

void check_transfer(const Place& place, const std::string& name, const Transfer& transfer, std::size_t rows,
                    std::size_t sources) {
  const std::string indices = name + "_index";
  expect_rows(place, indices, transfer.index.size() / transfer.width, rows);
  expect_rows(place, name + "_weight", transfer.weight.size() / transfer.width, rows);
  for (std::size_t i = 0; i < transfer.index.size(); ++i) {
    check_index(place, indices, i / transfer.width, transfer.index[i], sources);
  }
  check_weights(place, name + "_weight", transfer.weight, transfer.width);
}

void check_shapes(const Place& place, const Level& level) {
  if (level.tets.size() + level.faces.size() >= max_nodes) place.fail("tets", "too many nodes, allowed are below 2^31");
  expect_rows(place, "face_tets", level.face_tets.size(), level.faces.size());
  expect_rows(place, "links", level.links.size(), level.tets.size());
  expect_rows(place, "nodes", level.nodes.size(), level.tets.size() + level.faces.size());
}

// The row of a vertex without a tet would be empty, and the fem system singular.
void check_vertices_used(const Place& place, const Level& level) {
  std::vector<bool> used(level.vertices.size(), false);
  for (const glm::uvec4& tet : level.tets) {
    for (int k = 0; k < 4; ++k) used[tet[k]] = true;
  }
  const auto lonely = std::find(used.begin(), used.end(), false);
  if (lonely != used.end()) {
    place.fail("vertices", static_cast<std::size_t>(lonely - used.begin()), "no tet uses this vertex");
  }
}

void check_face_kinds(const Place& place, const Level& level) {
  if (level.face_kinds.empty()) return;
  expect_rows(place, "face_kinds", level.face_kinds.size(), level.faces.size());
  for (std::size_t f = 0; f < level.face_kinds.size(); ++f) {
    if (level.face_kinds[f] > face_reflecting) place.fail("face_kinds", f, "allowed are 0 (open) and 1 (reflecting)");
  }
}

bool equal_up_to_rotation(const glm::uvec3& a, const glm::uvec3& b) {
  return a == b || a == glm::uvec3(b.y, b.z, b.x) || a == glm::uvec3(b.z, b.x, b.y);
}

void check_outside_link(const Place& place, const Level& level, std::size_t t, int k) {
  const std::size_t f = level.links[t][k] - level.tets.size();
  if (level.face_tets[f] != t) place.fail("face_tets", f, "does not name the tet that links it");
  if (!equal_up_to_rotation(level.faces[f], outward_face(level.tets[t], k))) {
    place.fail("faces", f, "not the outward face of its tet opposite to the linking vertex");
  }
}

// Whether the neighbour across face k links back, across a face with the same three vertices.
bool linked_back(const Level& level, std::size_t t, int k) {
  const std::uint32_t other = level.links[t][k];
  const glm::uvec3 face = outward_face(level.tets[t], k);
  for (int back = 0; back < 4; ++back) {
    if (level.links[other][back] != t) continue;
    const glm::uvec3 seen = outward_face(level.tets[other], back);
    if (equal_up_to_rotation(face, glm::uvec3(seen.x, seen.z, seen.y))) return true;
  }
  return false;
}

// One of the two directions of each link is looked up: as every one of them has another back, and there are as many of
// the others, all have.
class InnerLinks {
 public:
  InnerLinks(const Place& place, const Level& level) : place_(place), level_(level) {}

  void add(std::size_t t, int k) {
    (level_.links[t][k] > t ? forward_ : backward_) += 1;
    if (level_.links[t][k] >= t && !linked_back(level_, t, k)) fail(t, k);
  }

  void finish() const {
    if (forward_ == backward_) return;
    for (std::size_t t = 0; t < level_.tets.size(); ++t) {
      for (int k = 0; k < 4; ++k) {
        if (level_.links[t][k] < t && !linked_back(level_, t, k)) fail(t, k);
      }
    }
  }

 private:
  [[noreturn]] void fail(std::size_t t, int k) const {
    place_.fail("links", t, "no link back from tet " + std::to_string(level_.links[t][k]) + " across the same face");
  }

  const Place& place_;
  const Level& level_;
  std::size_t forward_ = 0, backward_ = 0;
};

void check_links(const Place& place, const Level& level) {
  std::vector<bool> linked(level.faces.size(), false);
  InnerLinks inner(place, level);
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    int outside = 0;
    for (int k = 0; k < 4; ++k) {
      if (level.links[t][k] < level.tets.size()) {
        inner.add(t, k);
        continue;
      }
      check_outside_link(place, level, t, k);
      linked[level.links[t][k] - level.tets.size()] = true;
      ++outside;
    }
    if (outside > 1) place.fail("links", t, "more than one outside face");
  }
  inner.finish();
  const auto lonely = std::find(linked.begin(), linked.end(), false);
  if (lonely != linked.end()) {
    place.fail("faces", static_cast<std::size_t>(lonely - linked.begin()), "no tet links this surface node");
  }
}

void check_surface_vertices(const Place& place, const Level& level) {
  std::vector<bool> used(count_surface_vertices(level), false);
  for (const glm::uvec3& face : level.faces) used[face.x] = used[face.y] = used[face.z] = true;
  const auto gap = std::find(used.begin(), used.end(), false);
  if (gap != used.end()) {
    place.fail("vertices", static_cast<std::size_t>(gap - used.begin()),
               "surface vertices must come first, but no outside face uses this one");
  }
}

}  // namespace

std::uint32_t count_surface_vertices(const Level& level) {
  std::uint32_t largest = 0;
  for (const glm::uvec3& face : level.faces) largest = std::max({largest, face.x, face.y, face.z});
  return largest + 1;
}

void validate_indices(const Level& level, const std::string& file, std::uint32_t index) {
  const Place place{file, "level" + std::to_string(index) + "/"};
  check_shapes(place, level);
  check_finite(place, "vertices", level.vertices);
  check_finite(place, "nodes", level.nodes);
  check_indices(place, "tets", level.tets, level.vertices.size());
  check_indices(place, "faces", level.faces, level.vertices.size());
  check_indices(place, "links", level.links, level.nodes.size());
  for (std::size_t f = 0; f < level.face_tets.size(); ++f) {
    check_index(place, "face_tets", f, level.face_tets[f], level.tets.size());
  }
  check_face_kinds(place, level);
  validate_seen(level, file, index);
  validate_size(level.vertices, file, place.prefix + "vertices");
}

void validate_level(const Level& level, const Level* coarser, const std::string& file, std::uint32_t index) {
  const Place place{file, "level" + std::to_string(index) + "/"};
  validate_tets(level, file, index);
  check_vertices_used(place, level);
  check_links(place, level);
  check_surface_vertices(place, level);
  if (coarser == nullptr) return;
  check_transfer(place, "inner", level.inner, level.tets.size(), coarser->tets.size());
  check_transfer(place, "surface", level.surface, level.faces.size(), coarser->faces.size());
  check_transfer(place, "barycentric", level.barycentric, level.vertices.size(), coarser->vertices.size());
}

void validate_seen_once(std::span<const Level> levels, const std::string& file) {
  bool found = false;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (levels[i].seen.empty()) continue;
    if (found) fail_format(file, "level" + std::to_string(i) + "/seen", "only one level may have it");
    found = true;
  }
}

void validate_texture(const DisplayMesh& display, const Place& place) {
  constexpr float farthest = 1e6f;
  expect_rows(place, "texture_places", display.texture_places.size(), display.vertices.size());
  check_finite(place, "texture_places", display.texture_places);
  for (std::size_t i = 0; i < display.texture_places.size(); ++i) {
    const glm::vec3& at = display.texture_places[i];
    if (at.z != 0 && at.z != 1) place.fail("texture_places", i, "the third number is neither 0 nor 1");
    if (std::max(std::abs(at.x), std::abs(at.y)) > farthest) place.fail("texture_places", i, "beyond 1e6");
  }
  if (std::max(display.texture_columns, display.texture_rows) > most_texture_side) {
    fail_format(place.file, place.prefix + "normal_texture",
                "found " + std::to_string(display.texture_columns) + "x" + std::to_string(display.texture_rows) +
                    " texels, allowed are 1 to " + std::to_string(most_texture_side) + " a side");
  }
}

void validate_display(const DisplayMesh& display, const Level* finest, const std::string& file) {
  const Place place{file, "display/"};
  const std::size_t count = display.vertices.size();
  expect_rows(place, "normals", display.normals.size(), count);
  if (finest != nullptr) {
    expect_rows(place, "face", display.face.size(), count);
    expect_rows(place, "barycentric", display.barycentric.size(), count);
  }
  check_finite(place, "vertices", display.vertices);
  check_finite(place, "normals", display.normals);
  validate_size(display.vertices, file, "display/vertices");
  check_indices(place, "triangles", display.triangles, count);
  for (std::size_t i = 0; i < count; ++i) {
    if (finest != nullptr) check_index(place, "face", i, display.face[i], finest->faces.size());
    if (std::abs(glm::length(display.normals[i]) - 1.0f) > 1e-3f) place.fail("normals", i, "not of unit length");
  }
  if (!display.texture_places.empty()) validate_texture(display, place);
  if (finest == nullptr) return;
  const auto* weights = reinterpret_cast<const float*>(display.barycentric.data());
  check_weights(place, "barycentric", {weights, 3 * count}, 3);
}

}  // namespace quadgraph
