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

glm::dvec3 between(std::span<const glm::vec3> vertices, const glm::uvec3& t, const glm::dvec3& share) {
  return share.x * glm::dvec3(vertices[t.x]) + share.y * glm::dvec3(vertices[t.y]) +
         share.z * glm::dvec3(vertices[t.z]);
}

// Whether a triangle has no normal; what is on it is on its neighbours too.
bool is_flat(std::span<const glm::vec3> vertices, const glm::uvec3& t) {
  return frame_of(vertices, t)[2] == glm::dvec3(0);
}

// From a place to the box around a triangle, mm.
double distance_to_box(std::span<const glm::vec3> vertices, const glm::uvec3& t, const glm::vec3& p) {
  const glm::vec3 &a = vertices[t.x], &b = vertices[t.y], &c = vertices[t.z];
  const glm::vec3 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
  return double{glm::length(p - glm::clamp(p, low, high))};
}

// Shares of the corners in the place of a triangle that is nearest to `p`.
glm::dvec3 nearest_share(std::span<const glm::vec3> vertices, const glm::uvec3& t, const glm::dvec3& p) {
  const glm::dvec3 corners[] = {glm::dvec3(vertices[t.x]), glm::dvec3(vertices[t.y]), glm::dvec3(vertices[t.z])};
  const glm::dvec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0], ap = p - corners[0];
  const glm::dvec3 n = glm::cross(ab, ac) / std::max(glm::dot(glm::cross(ab, ac), glm::cross(ab, ac)), 1e-60);
  const double b = glm::dot(glm::cross(ap, ac), n), c = glm::dot(glm::cross(ab, ap), n);
  if (b >= 0 && c >= 0 && b + c <= 1 && n != glm::dvec3(0)) return {1 - b - c, b, c};
  glm::dvec3 best(1, 0, 0);
  double least = std::numeric_limits<double>::max();
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 &from = corners[i], edge = corners[(i + 1) % 3] - from;
    const double along = glm::clamp(glm::dot(p - from, edge) / std::max(glm::dot(edge, edge), 1e-60), 0.0, 1.0);
    const double away = glm::length(p - from - along * edge);
    if (away >= least) continue;
    least = away;
    best = glm::dvec3(0);
    best[i] = 1 - along;
    best[(i + 1) % 3] = along;
  }
  return best;
}

std::uint32_t number_of(const DisplayMesh& mesh, const glm::uvec3& triangle) {
  return static_cast<std::uint32_t>(&triangle - mesh.triangles.data());
}

}  // namespace

// The bake ties every vertex to a face of its own body.
std::uint32_t body_of(const Picked& picked, const QuadGraph& graph) {
  if (graph.bodies().empty() || graph.levels().empty()) return 0;
  const DisplayMesh& mesh = graph.display();
  return graph.levels()[0].body_of_face(mesh.face[mesh.triangles[picked.triangle].x]);
}

const std::string& body_name(const Picked& picked, const QuadGraph& graph) {
  static const std::string none;
  return graph.bodies().empty() ? none : graph.bodies()[body_of(picked, graph)];
}

std::optional<Picked> nearest_to(const DisplayMesh& mesh, std::span<const glm::vec3> vertices,
                                 const glm::vec3& at_rest) {
  const glm::uvec3* triangle = nullptr;
  glm::dvec3 share(0);
  double least = std::numeric_limits<double>::max();
  for (const glm::uvec3& t : mesh.triangles) {
    if (distance_to_box(mesh.vertices, t, at_rest) >= least) continue;
    const glm::dvec3 there = nearest_share(mesh.vertices, t, at_rest);
    const double away = glm::length(between(mesh.vertices, t, there) - glm::dvec3(at_rest));
    if (away >= least || is_flat(mesh.vertices, t) || is_flat(vertices, t)) continue;
    least = away;
    share = there;
    triangle = &t;
  }
  if (triangle == nullptr) return std::nullopt;
  const glm::dmat3 now = frame_of(vertices, *triangle);
  return Picked{glm::vec3(between(vertices, *triangle, share)), glm::vec3(between(mesh.vertices, *triangle, share)),
                glm::vec3(glm::normalize(now[2])), glm::mat3(frame_of(mesh.vertices, *triangle) * glm::inverse(now)),
                number_of(mesh, *triangle)};
}

std::optional<Picked> pick(const DisplayMesh& mesh, std::span<const glm::vec3> vertices, const Camera& camera,
                           const glm::vec2& at, std::span<const gpu::PathTool> tools) {
  const ViewRay ray = view_ray(camera, at);
  const glm::dvec3 &origin = ray.from, &direction = ray.along;
  double nearest = std::numeric_limits<double>::max();
  std::optional<Picked> found;
  const glm::uvec3* triangle = nullptr;
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
    triangle = &t;
    const glm::vec3 share(1 - u - v, u, v);
    found = Picked{position, share.x * mesh.vertices[t.x] + share.y * mesh.vertices[t.y] + share.z * mesh.vertices[t.z],
                   glm::vec3(glm::normalize(glm::cross(ab, ac)))};
  }
  if (!found) return found;
  found->to_rest = glm::mat3(frame_of(mesh.vertices, *triangle) * glm::inverse(frame_of(vertices, *triangle)));
  found->triangle = number_of(mesh, *triangle);
  const double back = std::min(nearest, double{camera.reach});
  move_to_cut(*found, mesh, vertices, *triangle, glm::dvec3(found->position) - back * direction, tools);
  return found;
}

}  // namespace quadgraph
