#include "engine/render/inside/false_mesh.h"

#include <glm/geometric.hpp>

namespace quadgraph {
namespace {

struct Crossing {
  glm::vec3 point;
  glm::vec4 weights;
};

Crossing crossing(const std::array<glm::vec3, 4>& tet, const std::array<float, 4>& height, int a, int b) {
  const float t = height[a] / (height[a] - height[b]);
  glm::vec4 weights(0);
  weights[a] = 1 - t;
  weights[b] = t;
  return {tet[a] + t * (tet[b] - tet[a]), weights};
}

// A polygon as triangles around its first corner; lines along its own edges only.
void add_polygon(FalseMesh& mesh, const Cut& cut, const std::array<float, 4>& values, bool edges) {
  for (std::size_t k = 1; k + 1 < cut.count; ++k) {
    std::uint32_t flags = 0;
    if (edges) {
      flags |= gpu::FALSE_EDGE;  // opposite the first corner
      if (k == 1) flags |= gpu::FALSE_EDGE << 2;
      if (k + 2 == cut.count) flags |= gpu::FALSE_EDGE << 1;
    }
    add_triangle(mesh, {cut.points[0], cut.points[k], cut.points[k + 1]}, {values[0], values[k], values[k + 1]}, flags);
  }
}

}  // namespace

void add_triangle(FalseMesh& mesh, const std::array<glm::vec3, 3>& corners, const std::array<float, 3>& values,
                  std::uint32_t flags) {
  for (std::size_t k = 0; k < 3; ++k) mesh.push_back({corners[k], values[k], flags});
}

void add_faces(FalseMesh& mesh, std::span<const glm::vec3> vertices, std::span<const glm::uvec3> faces,
               std::span<const float> values, std::uint32_t flags) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const glm::uvec3& face = faces[f];
    add_triangle(mesh, {vertices[face.x], vertices[face.y], vertices[face.z]}, {values[f], values[f], values[f]},
                 flags);
  }
}

Cut cut_of(const std::array<glm::vec3, 4>& tet, const Plane& plane) {
  std::array<float, 4> height{};
  std::array<int, 4> above{}, below{};
  int above_count = 0, below_count = 0;
  for (int k = 0; k < 4; ++k) {
    height[k] = glm::dot(glm::vec3(plane), tet[k]) - plane.w;
    if (height[k] > 0) {
      above[above_count++] = k;
    } else {
      below[below_count++] = k;
    }
  }
  Cut cut;
  const auto add = [&](int a, int b) {
    const Crossing c = crossing(tet, height, a, b);
    cut.points[cut.count] = c.point;
    cut.weights[cut.count++] = c.weights;
  };
  if (above_count == 2) {
    add(above[0], below[0]);
    add(above[0], below[1]);
    add(above[1], below[1]);
    add(above[1], below[0]);
  } else if (above_count == 1 || above_count == 3) {
    const int alone = above_count == 1 ? above[0] : below[0];
    const auto& others = above_count == 1 ? below : above;
    for (int k = 0; k < 3; ++k) add(alone, others[k]);
  }
  return cut;
}

void add_cuts(FalseMesh& mesh, std::span<const glm::vec3> vertices, std::span<const glm::uvec4> tets,
              const Plane& plane, bool edges, const std::function<glm::vec4(std::uint32_t)>& values) {
  for (std::uint32_t t = 0; t < tets.size(); ++t) {
    const glm::uvec4& tet = tets[t];
    const Cut cut = cut_of({vertices[tet.x], vertices[tet.y], vertices[tet.z], vertices[tet.w]}, plane);
    if (cut.count == 0) continue;
    const glm::vec4 corners = values(t);
    std::array<float, 4> at{};
    for (std::size_t k = 0; k < cut.count; ++k) at[k] = glm::dot(cut.weights[k], corners);
    add_polygon(mesh, cut, at, edges);
  }
}

}  // namespace quadgraph
