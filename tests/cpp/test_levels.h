// Levels built in memory for tests: a box of n x n x n cells, each cut into six tets (Kuhn), optionally jittered.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "engine/graph/graph.h"

namespace quadgraph {

// The arrays behind a Level. Corner tets may have two outside faces, which the operators do not mind.
struct OwnedLevel {
  std::vector<glm::vec3> vertices, nodes;
  std::vector<glm::uvec4> tets, links;
  std::vector<glm::uvec3> faces;
  std::vector<std::uint32_t> face_tets, face_kinds, seen;
  std::uint32_t seen_rays = 0;
  std::uint32_t surface_vertex_count = 0;

  Level view() const {
    Level level;
    level.vertices = vertices;
    level.tets = tets;
    level.faces = faces;
    level.face_tets = face_tets;
    level.links = links;
    level.nodes = nodes;
    level.face_kinds = face_kinds;
    level.seen = seen;
    level.seen_rays = seen_rays;
    level.surface_vertex_count = surface_vertex_count;
    return level;
  }
};

// Vertex numbers of the face opposite to vertex k of a positive tet, counter-clockwise from outside.
inline glm::uvec3 face_of(const glm::uvec4& t, int k) {
  const std::array<glm::uvec3, 4> faces = {
      {{t[1], t[2], t[3]}, {t[0], t[3], t[2]}, {t[0], t[1], t[3]}, {t[0], t[2], t[1]}}};
  return faces[static_cast<std::size_t>(k)];
}

// Surface vertices first, then links, faces and nodes (centroids) from the tets.
inline OwnedLevel level_from_tets(std::vector<glm::vec3> vertices, std::vector<glm::uvec4> tets) {
  std::map<std::array<std::uint32_t, 3>, std::vector<std::pair<std::uint32_t, int>>> sides;
  for (std::uint32_t t = 0; t < tets.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      const glm::uvec3 f = face_of(tets[t], k);
      std::array<std::uint32_t, 3> key = {f.x, f.y, f.z};
      std::sort(key.begin(), key.end());
      sides[key].emplace_back(t, k);
    }
  }
  std::vector<std::uint32_t> number(vertices.size(), UINT32_MAX);
  std::uint32_t next = 0;
  for (const auto& [key, users] : sides) {
    if (users.size() > 1) continue;
    for (std::uint32_t v : key) {
      if (number[v] == UINT32_MAX) number[v] = next++;
    }
  }
  OwnedLevel level;
  level.surface_vertex_count = next;
  for (std::uint32_t& n : number) {
    if (n == UINT32_MAX) n = next++;
  }
  level.vertices.resize(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) level.vertices[number[v]] = vertices[v];
  for (glm::uvec4 t : tets) level.tets.emplace_back(number[t[0]], number[t[1]], number[t[2]], number[t[3]]);

  const auto tet_count = static_cast<std::uint32_t>(tets.size());
  level.links.resize(tets.size());
  for (const auto& [key, users] : sides) {
    const auto [t, k] = users[0];
    if (users.size() == 2) {
      level.links[t][k] = users[1].first;
      level.links[users[1].first][users[1].second] = t;
    } else {
      level.links[t][k] = tet_count + static_cast<std::uint32_t>(level.faces.size());
      level.faces.push_back(face_of(level.tets[t], k));
      level.face_tets.push_back(t);
    }
  }
  for (const glm::uvec4& t : level.tets) {
    level.nodes.push_back((level.vertices[t[0]] + level.vertices[t[1]] + level.vertices[t[2]] + level.vertices[t[3]]) /
                          4.0f);
  }
  for (const glm::uvec3& f : level.faces) {
    level.nodes.push_back((level.vertices[f.x] + level.vertices[f.y] + level.vertices[f.z]) / 3.0f);
  }
  return level;
}

// A cube of `size` mm with one corner at the origin; inner vertices moved by up to `jitter` of a cell.
inline OwnedLevel box_level(std::uint32_t n, float size, float jitter = 0.0f) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> offset(-jitter, jitter);
  const float cell = size / static_cast<float>(n);
  const auto index = [n](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return x + (n + 1) * (y + (n + 1) * z); };
  std::vector<glm::vec3> vertices;
  for (std::uint32_t z = 0; z <= n; ++z) {
    for (std::uint32_t y = 0; y <= n; ++y) {
      for (std::uint32_t x = 0; x <= n; ++x) {
        glm::vec3 p(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
        const bool inside = x > 0 && y > 0 && z > 0 && x < n && y < n && z < n;
        if (inside) p += glm::vec3(offset(random), offset(random), offset(random));
        vertices.push_back(cell * p);
      }
    }
  }
  std::vector<glm::uvec4> tets;
  for (std::uint32_t z = 0; z < n; ++z) {
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        std::array<int, 3> axes = {0, 1, 2};
        do {
          glm::uvec3 p(x, y, z);
          glm::uvec4 tet;
          tet[0] = index(p.x, p.y, p.z);
          for (int step = 0; step < 3; ++step) {
            ++p[axes[static_cast<std::size_t>(step)]];
            tet[step + 1] = index(p.x, p.y, p.z);
          }
          const glm::vec3 a = vertices[tet[1]] - vertices[tet[0]];
          const glm::vec3 b = vertices[tet[2]] - vertices[tet[0]];
          const glm::vec3 c = vertices[tet[3]] - vertices[tet[0]];
          if (glm::dot(a, glm::cross(b, c)) < 0) std::swap(tet[2], tet[3]);
          tets.push_back(tet);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
    }
  }
  return level_from_tets(std::move(vertices), std::move(tets));
}

}  // namespace quadgraph
