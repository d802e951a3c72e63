#include "engine/render/display/pick.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace quadgraph {

namespace {

bool cut_away(std::span<const gpu::PathTool> tools, const glm::vec3& point) {
  return std::ranges::any_of(tools, [&](const gpu::PathTool& tool) { return gpu::tool_distance(tool, point) < 0; });
}

// Two edges of a triangle and its normal, as long as the edges are on the average (path_cost.comp).
glm::dmat3 frame_of(std::span<const glm::vec3> vertices, const glm::uvec3& t) {
  const glm::dvec3 a(vertices[t.x]), ab = glm::dvec3(vertices[t.y]) - a, ac = glm::dvec3(vertices[t.z]) - a;
  const glm::dvec3 n = glm::cross(ab, ac);
  return {ab, ac, n / std::sqrt(std::max(glm::length(n), 1e-30))};
}

// Where a ray that comes from `start` and from within to what has been `found` on triangle `t` has last left a tool.
void move_to_cut(Picked& found, const DisplayMesh& mesh, std::span<const glm::vec3> vertices, const glm::uvec3& t,
                 const glm::vec3& start, std::span<const gpu::PathTool> tools) {
  const glm::vec3 way = found.position - start;
  if (glm::dot(way, found.normal) <= 0) return;
  float latest = 0;
  for (const gpu::PathTool& tool : tools) {
    const glm::vec2 span = gpu::tool_span(tool, start, way);
    if (span.x >= span.y || span.y <= latest || span.y >= 1) continue;
    latest = span.y;
    found.position = start + latest * way;
    found.normal = -gpu::tool_gradient(tool, found.position);
  }
  if (latest == 0) return;
  found.at_rest = mesh.vertices[t.x] + found.to_rest * (found.position - vertices[t.x]);
}

}  // namespace

std::optional<Picked> pick(const DisplayMesh& mesh, std::span<const glm::vec3> vertices, const Camera& camera,
                           const glm::vec2& at, std::span<const gpu::PathTool> tools) {
  const ViewRay ray = view_ray(camera, at);
  const glm::dvec3 &origin = ray.from, &direction = ray.along;
  double nearest = std::numeric_limits<double>::max();
  std::optional<Picked> found;
  glm::uvec3 triangle(0);
  for (const glm::uvec3& t : mesh.triangles) {
    // Moeller and Trumbore 1997.
    const glm::dvec3 a(vertices[t.x]), ab = glm::dvec3(vertices[t.y]) - a, ac = glm::dvec3(vertices[t.z]) - a;
    const glm::dvec3 p = glm::cross(direction, ac);
    const double det = glm::dot(ab, p);
    if (det == 0) continue;
    const double u = glm::dot(origin - a, p) / det;
    const glm::dvec3 q = glm::cross(origin - a, ab);
    const double v = glm::dot(direction, q) / det, distance = glm::dot(ac, q) / det;
    if (u < 0 || v < 0 || u + v > 1 || distance <= 0 || distance >= nearest) continue;
    const glm::vec3 position(origin + distance * direction);
    if (cut_away(tools, position)) continue;
    nearest = distance;
    triangle = t;
    const glm::vec3 share(1 - u - v, u, v);
    found = Picked{position, share.x * mesh.vertices[t.x] + share.y * mesh.vertices[t.y] + share.z * mesh.vertices[t.z],
                   glm::vec3(glm::normalize(glm::cross(ab, ac)))};
  }
  if (!found) return found;
  found->to_rest = glm::mat3(frame_of(mesh.vertices, triangle) * glm::inverse(frame_of(vertices, triangle)));
  const double back = std::min(nearest, double{camera.reach});
  move_to_cut(*found, mesh, vertices, triangle, glm::dvec3(found->position) - back * direction, tools);
  return found;
}

}  // namespace quadgraph
