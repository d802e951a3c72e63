// Closed test bodies, as display mesh and as level 0 of a simulation at once.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "engine/render/display_buffers.h"
#include "engine/solve/simulation.h"

namespace quadgraph {

struct Shape {
  std::vector<glm::vec3> vertices, normals;  // mm
  std::vector<glm::uvec3> faces;             // counter-clockwise from outside

  void append(const Shape& other) {
    const auto base = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    normals.insert(normals.end(), other.normals.begin(), other.normals.end());
    for (const glm::uvec3& f : other.faces) faces.push_back(f + base);
  }
};

// An octahedron split `splits` times and blown up: 8 * 4^splits faces.
inline Shape sphere(const glm::vec3& centre, float radius, int splits) {
  Shape shape;
  std::vector<glm::vec3>& unit = shape.normals;
  unit = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  shape.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int s = 0; s < splits; ++s) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(unit.size()));
      if (fresh) unit.push_back(glm::normalize(unit[a] + unit[b]));
      return entry->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& f : shape.faces) {
      const glm::uvec3 m(middle(f.x, f.y), middle(f.y, f.z), middle(f.z, f.x));
      finer.insert(finer.end(), {{f.x, m.x, m.z}, {m.x, f.y, m.y}, {m.z, m.y, f.z}, m});
    }
    shape.faces = finer;
  }
  for (const glm::vec3& n : unit) shape.vertices.push_back(centre + radius * n);
  return shape;
}

inline glm::vec3 face_normal(const Shape& shape, std::size_t f) {
  const glm::uvec3& t = shape.faces[f];
  const glm::vec3& a = shape.vertices[t.x];
  return glm::cross(shape.vertices[t.y] - a, shape.vertices[t.z] - a);  // length: twice the area, mm^2
}

// Every display vertex sits on a corner of a face of level 0, which is the same surface.
inline DisplayBuffers upload_as_display(vk::Context& context, const Shape& shape) {
  std::vector<std::uint32_t> face(shape.vertices.size());
  std::vector<glm::vec3> barycentric(shape.vertices.size());
  for (std::size_t f = 0; f < shape.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = shape.faces[f][k];
      face[v] = static_cast<std::uint32_t>(f);
      barycentric[v] = {k == 0, k == 1, k == 2};
    }
  }
  return upload_display(context, {shape.vertices, shape.normals, shape.faces, face, barycentric});
}

// The buffers of a level that lights and display use.
inline LevelBuffers upload_as_level(vk::Context& context, const Shape& shape, std::size_t light_count) {
  LevelBuffers level;
  level.vertex_count = level.surface_vertex_count = static_cast<std::uint32_t>(shape.vertices.size());
  level.face_count = static_cast<std::uint32_t>(shape.faces.size());
  level.vertices = vk::upload<glm::vec3>(context, shape.vertices, "vertices");
  level.faces = vk::upload<glm::uvec3>(context, shape.faces, "faces");
  level.q = vk::Buffer(context, 12 * shape.faces.size(), vk::Place::read, "q");
  level.beam_q =
      vk::Buffer(context, sizeof(float) * FACE_QUARTERS * light_count * shape.faces.size(), vk::Place::read, "beam q");
  const std::vector<float> sky(shape.faces.size(), 1.0f);
  level.sky = vk::upload<float>(context, sky, "sky");
  return level;
}

}  // namespace quadgraph
