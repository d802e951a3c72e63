#include "engine/render/body_grid.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t points_along = 128;  // the longest side
constexpr std::uint32_t nothing = ~0u;       // no body

// Points over a box, x fastest.
struct Points {
  glm::vec3 first{0};
  float spacing = 1;
  glm::uvec3 size{1};

  std::size_t count() const { return std::size_t{size.x} * size.y * size.z; }
  std::size_t number(const glm::uvec3& at) const { return (std::size_t{at.z} * size.y + at.y) * size.x + at.x; }
  glm::vec3 place(const glm::uvec3& at) const { return first + spacing * glm::vec3(at); }
  glm::uvec3 near(const glm::vec3& place) const {
    return glm::uvec3(glm::clamp((place - first) / spacing, glm::vec3(0), glm::vec3(size - 1u)));
  }

  template <typename Function>
  void each(const glm::uvec3& low, const glm::uvec3& high, const Function& function) const {
    for (std::uint32_t z = low.z; z <= high.z; ++z) {
      for (std::uint32_t y = low.y; y <= high.y; ++y) {
        for (std::uint32_t x = low.x; x <= high.x; ++x) function(glm::uvec3(x, y, z));
      }
    }
  }
};

Points points_over(const Level& level) {
  glm::vec3 low = level.vertices[0], high = low;
  for (const glm::vec3& p : level.vertices) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::vec3 side = high - low;
  const float spacing = std::max({side.x, side.y, side.z}) / static_cast<float>(points_along - 1);
  return {low, spacing, glm::uvec3(glm::ceil(side / spacing)) + 1u};
}

void mark_tet(const Level& level, std::uint32_t tet, const Points& points, std::vector<std::uint32_t>& body) {
  const glm::uvec4& ids = level.tets[tet];
  const glm::vec3 origin = level.vertices[ids[3]];
  glm::vec3 low = origin, high = origin;
  glm::mat3 edges(0);
  for (int k = 0; k < 3; ++k) {
    const glm::vec3& p = level.vertices[ids[k]];
    edges[k] = p - origin;
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  if (glm::determinant(edges) == 0) return;
  const glm::mat3 inverse = glm::inverse(edges);
  const glm::uvec3 last = points.near(high) + 1u;
  points.each(points.near(low), glm::min(last, points.size - 1u), [&](const glm::uvec3& at) {
    constexpr float slack = 1e-4f;  // of points on a face
    const glm::vec3 l = inverse * (points.place(at) - origin);
    if (std::min({l.x, l.y, l.z, 1 - l.x - l.y - l.z}) >= -slack) body[points.number(at)] = level.body_of_tet(tet);
  });
}

// Points beside the bodies take the body of a neighbour, step by step, as far as values are looked up between points.
void spread(const Points& points, std::vector<std::uint32_t>& body) {
  constexpr int steps = 3;
  for (int step = 0; step < steps; ++step) {
    const std::vector<std::uint32_t> before = body;
    points.each(glm::uvec3(0), points.size - 1u, [&](const glm::uvec3& at) {
      std::uint32_t& own = body[points.number(at)];
      for (int k = 0; k < 6 && own == nothing; ++k) {
        glm::uvec3 other = at;
        other[k / 2] += k % 2 == 0 ? 1 : -1;
        if (other[k / 2] < points.size[k / 2]) own = before[points.number(other)];
      }
    });
  }
}

void check_one_index(std::span<const BodyMaterial> materials, std::span<const std::string> bodies) {
  for (std::size_t i = 1; i < materials.size(); ++i) {
    if (materials[i].eta == materials[0].eta) continue;
    throw InputError("shortest-path: eta=" + number_text(materials[0].eta) + " found of '" + bodies[0] +
                     "' and eta=" + number_text(materials[i].eta) + " of '" + bodies[i] +
                     "', allowed is one index of refraction for all bodies: give both the same eta");
  }
}

}  // namespace

GivenGrid grid_of_bodies(const Level& level, std::span<const BodyMaterial> materials,
                         std::span<const std::string> bodies) {
  check_one_index(materials, bodies);
  const Points points = points_over(level);
  std::vector<std::uint32_t> body(points.count(), nothing);
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) mark_tet(level, t, points, body);
  spread(points, body);
  GivenGrid made{.grid = {}, .optical = std::vector<gpu::Optical>(points.count(), {glm::vec3(0), glm::vec3(1)})};
  std::vector<std::size_t> rows;
  std::vector<glm::vec3> places;
  points.each(glm::uvec3(0), points.size - 1u, [&](const glm::uvec3& at) {
    if (body[points.number(at)] == nothing) return;
    rows.push_back(points.number(at));
    places.push_back(points.place(at));
  });
  const std::vector<gpu::Optical> found =
      coefficients(level, places, [&](std::uint32_t i) { return body[rows[i]]; }, materials);
  for (std::size_t k = 0; k < rows.size(); ++k) made.optical[rows[k]] = found[k];
  made.grid = {.size = points.size,
               .optical = made.optical,
               .spacing = glm::vec3(points.spacing),
               .first = points.first,
               .eta = materials[0].eta};
  return made;
}

}  // namespace quadgraph
