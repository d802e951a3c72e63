// The rules of what faces see, and that some rows are what their rays meet.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <string>
#include <vector>

#include "engine/file/geometry.h"
#include "engine/file/section_table.h"
#include "engine/file/validate.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t most_rays = 4096;                  // the bake takes no more
constexpr double lift = 1e-6;                              // of the body's size, by which rays start above their face
constexpr double golden_turn = 0.6180339887498949;         // azimuths of successive faces are spread evenly
constexpr std::size_t most_rows = 32, least_rows = 4;      // that are cast again
constexpr std::size_t pair_budget = std::size_t{1} << 22;  // rays times faces, where that leaves least_rows
constexpr std::size_t most_candidates = 64, most_places = 2048;  // faces that rows are chosen from, vertices by which
constexpr double relief = 1e-3;           // of the body's size, how far above a face a vertex counts
constexpr double differing_share = 0.01;  // of all these rays: those that graze an edge
constexpr std::size_t least_differing = 2;

double square(const glm::dvec3& v) {
  return glm::dot(v, v);
}

using Corners = std::array<glm::dvec3, 3>;

[[noreturn]] void fail(const std::string& file, std::uint32_t level, const std::string& rule) {
  fail_format(file, "level" + std::to_string(level) + "/seen", rule);
}

std::string at(std::size_t row) {
  return "row " + std::to_string(row) + ": ";
}

std::span<const std::uint32_t> row_of(const Level& level, std::size_t f) {
  return level.seen.subspan(level.seen[f], level.seen[f + 1] - level.seen[f]);
}

// Rows begin one after the other, behind their own n_f + 1 beginnings, and end where the section does.
void check_rows(const Level& level, const std::string& file, std::uint32_t index) {
  const std::size_t faces = level.faces.size();
  if (level.seen.size() < faces + 1) {
    fail(file, index, std::to_string(level.seen.size()) + " values, expected at least " + std::to_string(faces + 1));
  }
  if (level.seen[0] != faces + 1) fail(file, index, at(0) + "must begin at " + std::to_string(faces + 1));
  if (level.seen[faces] != level.seen.size()) {
    fail(file, index,
         "the last row ends at " + std::to_string(level.seen[faces]) + ", the section at " +
             std::to_string(level.seen.size()));
  }
  for (std::size_t f = 0; f < faces; ++f) {
    if (level.seen[f + 1] < level.seen[f]) fail(file, index, at(f) + "ends before it begins");
    const std::size_t entries = level.seen[f + 1] - level.seen[f];
    if (entries > level.seen_rays) {
      fail(file, index,
           at(f) + std::to_string(entries) + " entries, allowed are at most " + std::to_string(level.seen_rays) +
               ", the rays of a face");
    }
  }
}

double radical_inverse(std::uint32_t i) {
  double inverse = 0;
  for (double digit = 0.5; i > 0; i >>= 1, digit /= 2) inverse += digit * (i & 1);
  return inverse;
}

// Unit directions of docs/qgraph-format.md in the face's own frame, z along its normal: ascending by angle from it.
std::vector<glm::dvec3> rays_of(std::uint32_t face, std::uint32_t rays) {
  std::vector<glm::dvec3> ways;
  for (std::uint32_t i = 0; i < rays; ++i) {
    const double u = (i + 0.5) / rays, turn = radical_inverse(i) + face * golden_turn;
    const double azimuth = glm::two_pi<double>() * (turn - std::floor(turn));
    ways.emplace_back(std::sqrt(u) * std::cos(azimuth), std::sqrt(u) * std::sin(azimuth), std::sqrt(1 - u));
  }
  return ways;
}

// The faces that rays from one face meet first, as far as `meet` has seen.
class Row {
 public:
  Row(std::uint32_t face, std::uint32_t rays) : ways_(rays_of(face, rays)), nearest_(rays) {}

  // Corners in the frame of the face that sends the rays, its lifted centroid at 0.
  void meet(const Corners& c, std::uint32_t face) {
    // Normals of the planes through the origin and an edge; a ray between all three meets the face.
    glm::dvec3 ab = glm::cross(c[0], c[1]), bc = glm::cross(c[1], c[2]), ca = glm::cross(c[2], c[0]);
    const double volume = glm::dot(c[0], bc);  // six times that of the tet with the origin; negative from outside
    if (volume == 0) return;
    for (glm::dvec3* normal : {&ab, &bc, &ca}) *normal /= volume;
    const auto [begin, end] = range(c);
    for (std::size_t i = begin; i < end; ++i) {
      const double p = glm::dot(ab, ways_[i]), q = glm::dot(bc, ways_[i]), r = glm::dot(ca, ways_[i]);
      const double nearness = p + q + r;  // 1 / distance
      if (std::min(std::min(p, q), r) >= 0 && nearness > nearest_[i].nearness) {
        nearest_[i] = {nearness, face, volume < 0};
      }
    }
  }

  // Ascending, those met from outside.
  std::vector<std::uint32_t> met() const {
    std::vector<std::uint32_t> faces;
    for (const Met& ray : nearest_) {
      if (ray.outside) faces.push_back(ray.face);
    }
    std::sort(faces.begin(), faces.end());
    return faces;
  }

 private:
  struct Met {
    double nearness = 0;
    std::uint32_t face = 0;
    bool outside = false;
  };

  // First ray, and the one after the last, at the angles from z of the cone around a sphere around a triangle.
  std::array<std::size_t, 2> range(const Corners& c) const {
    const glm::dvec3 middle = (c[0] + c[1] + c[2]) / 3.0;
    const double radius = std::sqrt(std::max({square(c[0] - middle), square(c[1] - middle), square(c[2] - middle)})),
                 distance = glm::length(middle), sine = radius / distance;
    if (!(sine < 1)) return {0, ways_.size()};
    const double z = middle.z / distance, cosine = std::sqrt(1 - sine * sine),
                 across = std::sqrt(std::max(1 - z * z, 0.0)) * sine;
    const double highest = z >= cosine ? 1 : std::clamp(z * cosine + across, 0.0, 1.0);
    const double lowest = std::clamp(z * cosine - across, 0.0, 1.0);
    // z of ray i is sqrt(1 - (i + 1/2) / rays); one more on either side for rounding.
    const double rays = static_cast<double>(ways_.size());
    return {static_cast<std::size_t>(std::max(std::floor((1 - highest * highest) * rays - 1.5), 0.0)),
            static_cast<std::size_t>(std::min(std::ceil((1 - lowest * lowest) * rays + 1.5), rays))};
  }

  std::vector<glm::dvec3> ways_;
  std::vector<Met> nearest_;
};

// How many of one list are missing in the other, both ascending.
std::size_t missing(std::span<const std::uint32_t> list, std::span<const std::uint32_t> other) {
  std::vector<std::uint32_t> left;
  std::set_difference(list.begin(), list.end(), other.begin(), other.end(), std::back_inserter(left));
  return left.size();
}

// Casts the rays of single faces.
class Caster {
 public:
  explicit Caster(const Level& level) : level_(level), local_(count_surface_vertices(level)) {
    glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
    for (const glm::vec3& vertex : level.vertices.first(local_.size())) {
      low = glm::min(low, glm::dvec3(vertex));
      high = glm::max(high, glm::dvec3(vertex));
    }
    size_ = glm::length(high - low);
  }

  // Faces whose rays are to be cast: some that have the most of the body above them, some with less, some with none.
  std::vector<std::uint32_t> rows() const {
    const std::size_t faces = level_.faces.size(), count = std::min(most_candidates, faces),
                      wanted = std::clamp(pair_budget / (faces * level_.seen_rays), least_rows, most_rows),
                      rows = std::min(wanted, count);
    std::vector<std::array<std::size_t, 2>> candidates;  // vertices above, face
    for (std::size_t k = 0; k < count; ++k) candidates.push_back({above(k * faces / count), k * faces / count});
    std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a[0] > b[0]; });
    std::vector<std::uint32_t> chosen;
    for (std::size_t k = 0; k < rows; ++k) {
      chosen.push_back(static_cast<std::uint32_t>(candidates[k * count / rows][1]));
    }
    return chosen;
  }

  std::vector<std::uint32_t> cast(std::uint32_t face) {
    const glm::uvec3& own = level_.faces[face];
    const glm::dvec3 a(level_.vertices[own.x]), b(level_.vertices[own.y]), c(level_.vertices[own.z]);
    const glm::dvec3 n = glm::normalize(face_vector(level_, own)), t1 = glm::normalize(b - a);
    const glm::dvec3 origin = (a + b + c) / 3.0 + lift * size_ * n;
    const glm::dmat3 to_local = glm::transpose(glm::dmat3(t1, glm::cross(n, t1), n));
    for (std::size_t v = 0; v < local_.size(); ++v) local_[v] = to_local * (glm::dvec3(level_.vertices[v]) - origin);
    Row row(face, level_.seen_rays);
    for (std::uint32_t f = 0; f < level_.faces.size(); ++f) {
      const glm::uvec3& ids = level_.faces[f];
      const Corners corners = {local_[ids.x], local_[ids.y], local_[ids.z]};
      if (f != face && std::max({corners[0].z, corners[1].z, corners[2].z}) > 0) row.meet(corners, f);
    }
    return row.met();
  }

 private:
  // How many of some vertices lie clearly above a face.
  std::size_t above(std::size_t face) const {
    const glm::dvec3 n = glm::normalize(face_vector(level_, level_.faces[face]));
    const glm::uvec3& own = level_.faces[face];
    const double level = glm::dot(n, (glm::dvec3(level_.vertices[own.x]) + glm::dvec3(level_.vertices[own.y]) +
                                      glm::dvec3(level_.vertices[own.z])) /
                                         3.0);
    std::size_t result = 0;
    for (std::size_t v = 0; v < local_.size(); v += std::max<std::size_t>(local_.size() / most_places, 1)) {
      result += glm::dot(n, glm::dvec3(level_.vertices[v])) - level > relief * size_ ? 1 : 0;
    }
    return result;
  }

  const Level& level_;
  std::vector<glm::dvec3> local_;  // surface vertices, mm
  double size_ = 0;                // mm
};

}  // namespace

void validate_seen(const Level& level, const std::string& file, std::uint32_t index) {
  if (level.seen.empty()) return;
  if (level.seen_rays == 0 || level.seen_rays > most_rays) {
    fail_format(file, "level" + std::to_string(index) + "/seen_rays",
                std::to_string(level.seen_rays) + " found, 1 to " + std::to_string(most_rays) + " allowed");
  }
  check_rows(level, file, index);
  for (std::size_t f = 0; f < level.faces.size(); ++f) {
    const auto row = row_of(level, f);
    if (!std::is_sorted(row.begin(), row.end())) {
      fail(file, index, at(f) + "faces are not in ascending order");
    }
    for (const std::uint32_t face : row) {
      if (face >= level.faces.size()) {
        fail(file, index,
             at(f) + "face " + std::to_string(face) + ", allowed is below " + std::to_string(level.faces.size()));
      }
      if (face == f) fail(file, index, at(f) + "a face does not see itself");
    }
  }
}

void validate_seen_again(const Level& level, const std::string& file, std::uint32_t index) {
  if (level.seen.empty()) return;
  Caster caster(level);
  const std::vector<std::uint32_t> rows = caster.rows();
  const std::size_t rays = rows.size() * level.seen_rays;
  std::size_t unsaid = 0, invented = 0;
  for (const std::uint32_t f : rows) {
    const std::vector<std::uint32_t> met = caster.cast(f);
    unsaid += missing(met, row_of(level, f));
    invented += missing(row_of(level, f), met);
  }
  const std::size_t differing = std::max(unsaid, invented),
                    allowed = std::max(static_cast<std::size_t>(differing_share * static_cast<double>(rays)),
                                       least_differing);
  if (differing <= allowed) return;
  fail(file, index,
       std::to_string(differing) + " of the " + std::to_string(rays) + " rays of " + std::to_string(rows.size()) +
           " rows meet other faces than are stored, allowed are " + std::to_string(allowed) + "; bake the body again");
}

}  // namespace quadgraph
