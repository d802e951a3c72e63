// Triangles for views of the inside: surfaces and cuts through tets, with a value along the colour bar at every corner.
#pragma once

#include <array>
#include <functional>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "shaders/display/false_colour_shared.h"

namespace quadgraph {

using FalseMesh = std::vector<gpu::FalseVertex>;  // three per triangle

// Points with dot(plane.xyz, p) <= plane.w lie behind it.
using Plane = glm::vec4;

// The part of a tet's face, or all of it, in one colour; `flags` as gpu::FalseVertex.
void add_triangle(FalseMesh& mesh, const std::array<glm::vec3, 3>& corners, const std::array<float, 3>& values,
                  std::uint32_t flags);

// Faces in one colour each.
void add_faces(FalseMesh& mesh, std::span<const glm::vec3> vertices, std::span<const glm::uvec3> faces,
               std::span<const float> values, std::uint32_t flags);

// Where a plane cuts a tet: none, 3 or 4 points in a circle, and the weights of the tet's corners in each.
struct Cut {
  std::size_t count = 0;
  std::array<glm::vec3, 4> points;
  std::array<glm::vec4, 4> weights;
};
Cut cut_of(const std::array<glm::vec3, 4>& tet, const Plane& plane);

// The cuts of all tets, `values(tet)` along the colour bar at their corners; `edges`: with lines between tets.
void add_cuts(FalseMesh& mesh, std::span<const glm::vec3> vertices, std::span<const glm::uvec4> tets,
              const Plane& plane, bool edges, const std::function<glm::vec4(std::uint32_t)>& values);

}  // namespace quadgraph
