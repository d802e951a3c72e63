// What lies under a point of a picture.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>

#include "engine/file/graph.h"
#include "engine/render/display/camera.h"
#include "shaders/path/path_tools.h"

namespace quadgraph {

struct Picked {
  glm::vec3 position{0};       // mm, where the surface is now
  glm::vec3 at_rest{0};        // mm, where that point lies in the file
  glm::vec3 normal{0};         // unit, of the triangle, now
  glm::mat3 to_rest{1};        // directions now to those in the file, as the triangle was deformed
  std::uint32_t triangle = 0;  // of the display mesh
};

// The body that it is on, by QuadGraph::bodies; 0 where there is one without a name.
std::uint32_t body_of(const Picked& picked, const QuadGraph& graph);

// Its name; empty where there is one without.
const std::string& body_name(const Picked& picked, const QuadGraph& graph);

// The nearest point of the display mesh, whose vertices are now at `vertices`, mm, on the ray through `at`: of a
// picture seen from `camera`, -1 to 1 from left to right and from bottom to top. What is in
// `tools` is cut away, and cut faces are met as surface_path.frag shows them; at rest they lie where the triangle
// behind them says. Empty where there is nothing.
std::optional<Picked> pick(const DisplayMesh& mesh, std::span<const glm::vec3> vertices, const Camera& camera,
                           const glm::vec2& at, std::span<const gpu::PathTool> tools = {});

// The place of the display mesh that is nearest to `at_rest`, mm, in the shape at rest; its vertices are now at
// `vertices`. Empty where the mesh has no triangles.
std::optional<Picked> nearest_to(const DisplayMesh& mesh, std::span<const glm::vec3> vertices,
                                 const glm::vec3& at_rest);

}  // namespace quadgraph
