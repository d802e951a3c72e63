// Bodies that see themselves, and what they see by brute force: the oracle of the exchange.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>

#include "tests/cpp/test_graphs.h"

namespace quadgraph {

inline glm::dvec3 at(const OwnedLevel& level, std::uint32_t vertex) {
  return glm::dvec3(level.vertices[vertex]);
}

// Distance along the ray to a face, infinite without a hit.
inline double distance_to(const OwnedLevel& level, std::uint32_t face, const glm::dvec3& from, const glm::dvec3& d) {
  const glm::uvec3& f = level.faces[face];
  const glm::dvec3 a = at(level, f.x), ab = at(level, f.y) - a, ac = at(level, f.z) - a;
  const glm::dvec3 p = glm::cross(d, ac);
  const double det = glm::dot(ab, p);
  if (det == 0) return std::numeric_limits<double>::infinity();
  const double u = glm::dot(from - a, p) / det;
  const glm::dvec3 q = glm::cross(from - a, ab);
  const double v = glm::dot(d, q) / det, t = glm::dot(ac, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : std::numeric_limits<double>::infinity();
}

inline glm::dvec3 normal_of(const OwnedLevel& level, std::uint32_t face) {
  const glm::uvec3& f = level.faces[face];
  return glm::normalize(glm::cross(at(level, f.y) - at(level, f.x), at(level, f.z) - at(level, f.x)));
}

// Direction of ray i of `rays` from a face (docs/qgraph-format.md, "What the faces see").
inline glm::dvec3 seen_ray(const OwnedLevel& level, std::uint32_t face, std::uint32_t i, std::uint32_t rays) {
  const glm::uvec3& f = level.faces[face];
  const glm::dvec3 n = normal_of(level, face), t1 = glm::normalize(at(level, f.y) - at(level, f.x));
  double turn = 0, digit = 0.5;
  for (std::uint32_t rest = i; rest > 0; rest /= 2, digit /= 2) turn += digit * (rest % 2);
  const double azimuth = 2 * std::numbers::pi * (turn + face * 0.6180339887498949), u = (i + 0.5) / rays;
  return std::sqrt(u) * (std::cos(azimuth) * t1 + std::sin(azimuth) * glm::cross(n, t1)) + std::sqrt(1 - u) * n;
}

// Faces met by the rays of one face, ascending.
inline std::vector<std::uint32_t> seen_by(const OwnedLevel& level, std::uint32_t face, std::uint32_t rays) {
  const glm::uvec3& f = level.faces[face];
  const glm::dvec3 centre = (at(level, f.x) + at(level, f.y) + at(level, f.z)) / 3.0;
  std::vector<std::uint32_t> row;
  for (std::uint32_t i = 0; i < rays; ++i) {
    const glm::dvec3 d = seen_ray(level, face, i, rays);
    double nearest = std::numeric_limits<double>::infinity();
    std::uint32_t met = face;
    for (std::uint32_t g = 0; g < level.faces.size(); ++g) {
      if (g == face) continue;
      const double t = distance_to(level, g, centre, d);
      if (t < nearest) nearest = t, met = g;
    }
    if (met != face && glm::dot(d, normal_of(level, met)) < 0) row.push_back(met);
  }
  std::sort(row.begin(), row.end());
  return row;
}

// Level::seen as the bake makes it.
inline void bake_seen(OwnedLevel& level, std::uint32_t rays) {
  level.seen_rays = rays;
  level.seen.assign(1, static_cast<std::uint32_t>(level.faces.size() + 1));
  std::vector<std::uint32_t> entries;
  for (std::uint32_t f = 0; f < level.faces.size(); ++f) {
    const std::vector<std::uint32_t> row = seen_by(level, f, rays);
    entries.insert(entries.end(), row.begin(), row.end());
    level.seen.push_back(level.seen[0] + static_cast<std::uint32_t>(entries.size()));
  }
  level.seen.insert(level.seen.end(), entries.begin(), entries.end());
}

inline OwnedLevel joined(const OwnedLevel& a, const OwnedLevel& b) {
  std::vector<glm::vec3> vertices = a.vertices;
  std::vector<glm::uvec4> tets = a.tets;
  vertices.insert(vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const glm::uvec4& t : b.tets) tets.push_back(t + static_cast<std::uint32_t>(a.vertices.size()));
  return level_from_tets(std::move(vertices), std::move(tets));
}

// A slab of cells cubed, `size` x `thickness` x `size` mm, its lowest y at `y`.
inline OwnedLevel slab(std::uint32_t cells, float size, float thickness, float y) {
  OwnedLevel level = split_at_centroids(box_level(cells, size));
  for (auto* points : {&level.vertices, &level.nodes}) {
    for (glm::vec3& p : *points) p.y = y + p.y * thickness / size;
  }
  return level;
}

// Two slabs across a gap around y = 0.
inline OwnedLevel facing_slabs(std::uint32_t cells, float size, float thickness, float gap) {
  return joined(slab(cells, size, thickness, gap / 2), slab(cells, size, thickness, -gap / 2 - thickness));
}

// Unit sphere of triangles: an octahedron, every triangle cut into n^2.
struct SphereMesh {
  std::vector<glm::dvec3> points;
  std::vector<glm::uvec3> triangles;  // counter-clockwise from outside
};

inline SphereMesh sphere_mesh(int n) {
  SphereMesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> number;
  const auto point = [&](const glm::ivec3& p) {
    const auto [found, fresh] = number.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(mesh.points.size()));
    if (fresh) mesh.points.push_back(glm::normalize(glm::dvec3(p)));
    return found->second;
  };
  for (int octant = 0; octant < 8; ++octant) {
    const glm::ivec3 sign(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
    const bool turned = sign.x * sign.y * sign.z < 0;
    const auto add = [&](glm::ivec3 a, glm::ivec3 b, glm::ivec3 c) {
      if (turned) std::swap(b, c);
      mesh.triangles.emplace_back(point(sign * a), point(sign * b), point(sign * c));
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        const glm::ivec3 a(n - i - j, i, j);
        add(a, a + glm::ivec3(-1, 1, 0), a + glm::ivec3(-1, 0, 1));
        if (i + j + 1 < n) add(a + glm::ivec3(-1, 1, 0), a + glm::ivec3(-2, 1, 1), a + glm::ivec3(-1, 0, 1));
      }
    }
  }
  return mesh;
}

inline OwnedLevel ball_level(int n, double radius) {
  const SphereMesh mesh = sphere_mesh(n);
  std::vector<glm::vec3> vertices{glm::vec3(0)};
  for (const glm::dvec3& p : mesh.points) vertices.emplace_back(radius * p);
  std::vector<glm::uvec4> tets;
  for (const glm::uvec3& t : mesh.triangles) tets.emplace_back(0, t.x + 1, t.y + 1, t.z + 1);
  return level_from_tets(std::move(vertices), std::move(tets));
}

// Between two concentric spheres; every layer of prisms cut into three tets each, by the numbers of the points so that
// neighbours agree.
inline OwnedLevel shell_level(int n, int layers, double inner, double outer) {
  const SphereMesh mesh = sphere_mesh(n);
  const auto count = static_cast<std::uint32_t>(mesh.points.size());
  std::vector<glm::vec3> vertices;
  for (int k = 0; k <= layers; ++k) {
    for (const glm::dvec3& p : mesh.points) vertices.emplace_back((inner + (outer - inner) * k / layers) * p);
  }
  std::vector<glm::uvec4> tets;
  for (int k = 0; k < layers; ++k) {
    const std::uint32_t low = count * static_cast<std::uint32_t>(k), high = low + count;
    for (glm::uvec3 t : mesh.triangles) {
      while (t.x > t.y || t.x > t.z) t = {t.y, t.z, t.x};
      if (t.y < t.z) {
        tets.insert(tets.end(), {{low + t.x, low + t.y, low + t.z, high + t.z},
                                 {low + t.x, low + t.y, high + t.z, high + t.y},
                                 {low + t.x, high + t.y, high + t.z, high + t.x}});
      } else {
        tets.insert(tets.end(), {{low + t.x, low + t.y, low + t.z, high + t.y},
                                 {low + t.x, high + t.y, low + t.z, high + t.z},
                                 {low + t.x, high + t.y, high + t.z, high + t.x}});
      }
    }
  }
  for (glm::uvec4& t : tets) {
    const glm::vec3 a = vertices[t[0]];
    if (glm::dot(vertices[t[1]] - a, glm::cross(vertices[t[2]] - a, vertices[t[3]] - a)) < 0) std::swap(t[2], t[3]);
  }
  return level_from_tets(std::move(vertices), std::move(tets));
}

using Motion = std::function<glm::vec3(const glm::vec3&)>;

inline glm::vec3 turned(const glm::vec3& p) {
  const float c = std::cos(0.7f), s = std::sin(0.7f);
  const glm::vec3 q(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
  return glm::vec3(q.x, c * q.y - s * q.z, s * q.y + c * q.z) + glm::vec3(3, -7, 20);
}

// Bends two slabs towards each other at their ends.
inline glm::vec3 bent(const glm::vec3& p) {
  const float x = p.x - 5.0f;
  return p + glm::vec3(0, -(p.y > 0 ? 1.0f : -1.0f) * 0.03f * x * x, 0);
}

inline OwnedLevel moved(OwnedLevel level, const Motion& motion) {
  for (glm::vec3& p : level.vertices) p = motion(p);
  const auto& v = level.vertices;
  level.nodes.clear();
  for (const glm::uvec4& t : level.tets) level.nodes.push_back((v[t[0]] + v[t[1]] + v[t[2]] + v[t[3]]) / 4.0f);
  for (const glm::uvec3& f : level.faces) level.nodes.push_back((v[f.x] + v[f.y] + v[f.z]) / 3.0f);
  return level;
}

}  // namespace quadgraph
