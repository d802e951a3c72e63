// Bodies that see themselves, and what their faces see, in double precision by brute force: docs/qgraph-format.md
// again, written without a look at the bake.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <map>
#include <vector>

#include "tests/cpp/test_levels.h"

namespace quadgraph {

struct Corners {
  glm::dvec3 a{0}, b{0}, c{0};

  glm::dvec3 centre() const { return (a + b + c) / 3.0; }
  glm::dvec3 normal() const { return glm::normalize(glm::cross(b - a, c - a)); }
};

inline Corners corners_of(const OwnedLevel& level, std::size_t f) {
  const glm::uvec3& face = level.faces[f];
  return {glm::dvec3(level.vertices[face.x]), glm::dvec3(level.vertices[face.y]), glm::dvec3(level.vertices[face.z])};
}

// Where the ray meets the triangle, in lengths of `way`; negative if it does not.
inline double distance_to(const Corners& triangle, const glm::dvec3& from, const glm::dvec3& way) {
  const glm::dvec3 n = glm::cross(triangle.b - triangle.a, triangle.c - triangle.a);
  const double distance = glm::dot(triangle.a - from, n) / glm::dot(way, n);
  if (!(distance > 0)) return -1;
  const glm::dvec3 at = from + distance * way;
  const auto left = [&](const glm::dvec3& p, const glm::dvec3& q) { return glm::dot(glm::cross(q - p, at - p), n); };
  const double least =
      std::min({left(triangle.a, triangle.b), left(triangle.b, triangle.c), left(triangle.c, triangle.a)});
  return least >= -1e-12 * glm::dot(n, n) ? distance : -1;
}

inline double radical_inverse_2(std::uint32_t i) {
  double result = 0, digit = 0.5;
  for (; i > 0; i /= 2, digit /= 2) result += digit * (i % 2);
  return result;
}

// Ray i of N from face f.
inline glm::dvec3 seen_ray(const Corners& face, std::uint32_t f, std::uint32_t i, std::uint32_t rays) {
  const double u = (i + 0.5) / rays;
  const double turn = radical_inverse_2(i) + f * 0.6180339887498949;
  const double azimuth = glm::two_pi<double>() * (turn - std::floor(turn));
  const glm::dvec3 n = face.normal(), t1 = glm::normalize(face.b - face.a), t2 = glm::cross(n, t1);
  return std::sqrt(u) * (std::cos(azimuth) * t1 + std::sin(azimuth) * t2) + std::sqrt(1 - u) * n;
}

// Fills `seen` and `seen_rays`.
inline void see(OwnedLevel& level, std::uint32_t rays) {
  std::vector<Corners> corners;
  for (std::size_t f = 0; f < level.faces.size(); ++f) corners.push_back(corners_of(level, f));
  const auto count = static_cast<std::uint32_t>(corners.size());
  std::vector<std::uint32_t> begins = {count + 1}, entries;
  for (std::uint32_t f = 0; f < count; ++f) {
    std::vector<std::uint32_t> row;
    for (std::uint32_t i = 0; i < rays; ++i) {
      const glm::dvec3 way = seen_ray(corners[f], f, i, rays);
      double nearest = INFINITY;
      std::uint32_t met = f;
      for (std::uint32_t g = 0; g < count; ++g) {
        const double distance = g == f ? -1 : distance_to(corners[g], corners[f].centre(), way);
        if (distance > 0 && distance < nearest) {
          nearest = distance;
          met = g;
        }
      }
      if (met != f && glm::dot(corners[met].normal(), way) < 0) row.push_back(met);
    }
    std::sort(row.begin(), row.end());
    entries.insert(entries.end(), row.begin(), row.end());
    begins.push_back(count + 1 + static_cast<std::uint32_t>(entries.size()));
  }
  level.seen_rays = rays;
  level.seen = begins;
  level.seen.insert(level.seen.end(), entries.begin(), entries.end());
}

// A sphere of 20 * 4^subdivisions triangles and unit radius.
inline void icosphere(std::uint32_t subdivisions, std::vector<glm::dvec3>& points, std::vector<glm::uvec3>& triangles) {
  const double g = glm::golden_ratio<double>();
  points.clear();
  for (const double s : {-1.0, 1.0}) {
    for (const double t : {-g, g}) points.insert(points.end(), {{0, s, t}, {s, t, 0}, {t, 0, s}});
  }
  for (glm::dvec3& p : points) p = glm::normalize(p);
  triangles.clear();
  const double edge = 1.1 * 2 / std::sqrt(1 + g * g);  // a little longer than the shortest distance
  const auto near = [&](std::uint32_t a, std::uint32_t b) { return glm::distance(points[a], points[b]) < edge; };
  for (std::uint32_t a = 0; a < 12; ++a) {
    for (std::uint32_t b = a + 1; b < 12; ++b) {
      for (std::uint32_t c = b + 1; c < 12; ++c) {
        if (near(a, b) && near(b, c) && near(a, c)) triangles.emplace_back(a, b, c);
      }
    }
  }
  for (std::uint32_t k = 0; k < subdivisions; ++k) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, added] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (added) points.push_back(glm::normalize(points[a] + points[b]));
      return found->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& t : triangles) {
      const std::uint32_t x = middle(t.x, t.y), y = middle(t.y, t.z), z = middle(t.z, t.x);
      finer.insert(finer.end(), {{t.x, x, z}, {x, t.y, y}, {z, y, t.z}, {x, y, z}});
    }
    triangles = finer;
  }
}

// The body between two concentric spheres, mm, in `layers` of prisms.
inline OwnedLevel shell_level(double inner, double outer, std::uint32_t layers, std::uint32_t subdivisions) {
  std::vector<glm::dvec3> sphere;
  std::vector<glm::uvec3> triangles;
  icosphere(subdivisions, sphere, triangles);
  const auto count = static_cast<std::uint32_t>(sphere.size());
  std::vector<glm::vec3> vertices;
  for (std::uint32_t l = 0; l <= layers; ++l) {
    for (const glm::dvec3& p : sphere) vertices.emplace_back((inner + (outer - inner) * l / layers) * p);
  }
  std::vector<glm::uvec4> tets;
  for (std::uint32_t l = 0; l < layers; ++l) {
    for (const glm::uvec3& triangle : triangles) {
      std::array<std::uint32_t, 3> low = {triangle.x, triangle.y, triangle.z};
      std::sort(low.begin(), low.end());  // so that neighbouring prisms agree on the diagonal between them
      for (std::uint32_t& v : low) v += l * count;
      const std::array<std::uint32_t, 3> high = {low[0] + count, low[1] + count, low[2] + count};
      tets.emplace_back(low[0], low[1], low[2], high[2]);
      tets.emplace_back(low[0], low[1], high[1], high[2]);
      tets.emplace_back(low[0], high[0], high[1], high[2]);
    }
  }
  for (glm::uvec4& t : tets) {
    const glm::vec3 &a = vertices[t[0]], &b = vertices[t[1]], &c = vertices[t[2]], &d = vertices[t[3]];
    if (glm::dot(b - a, glm::cross(c - a, d - a)) < 0) std::swap(t[2], t[3]);
  }
  return level_from_tets(std::move(vertices), std::move(tets));
}

// Two plates of edge x edge x thickness mm around the z axis, `gap` mm of z between them, n cells along every edge.
inline OwnedLevel facing_plates(std::uint32_t n, float edge, float thickness, float gap) {
  const OwnedLevel plate = box_level(n, 1.0f);
  std::vector<glm::vec3> vertices;
  std::vector<glm::uvec4> tets;
  for (const float z : {gap / 2, -gap / 2 - thickness}) {
    const auto start = static_cast<std::uint32_t>(vertices.size());
    for (const glm::vec3& p : plate.vertices) {
      vertices.emplace_back(edge * (p.x - 0.5f), edge * (p.y - 0.5f), z + thickness * p.z);
    }
    for (const glm::uvec4& t : plate.tets) tets.push_back(t + start);
  }
  return level_from_tets(std::move(vertices), std::move(tets));
}

}  // namespace quadgraph
