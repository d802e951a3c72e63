// Faces of a level's tets, and measures of its elements in double precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/file/graph.h"

namespace quadgraph {

// Vertices of the face opposite to vertex k of a positive tet, counter-clockwise seen from outside.
inline glm::uvec3 outward_face(const glm::uvec4& tet, int k) {
  switch (k) {
    case 0:
      return {tet[1], tet[2], tet[3]};
    case 1:
      return {tet[0], tet[3], tet[2]};
    case 2:
      return {tet[0], tet[1], tet[3]};
    default:
      return {tet[0], tet[2], tet[1]};
  }
}

// Six times the volume, mm^3; positive for a positively oriented tet.
inline double tet_determinant(const Level& level, const glm::uvec4& tet) {
  const glm::dvec3 p(level.vertices[tet[0]]);
  const glm::dvec3 e1 = glm::dvec3(level.vertices[tet[1]]) - p;
  const glm::dvec3 e2 = glm::dvec3(level.vertices[tet[2]]) - p;
  const glm::dvec3 e3 = glm::dvec3(level.vertices[tet[3]]) - p;
  return glm::dot(e1, glm::cross(e2, e3));
}

// mm^3.
inline double tet_volume(const Level& level, const glm::uvec4& tet) {
  return tet_determinant(level, tet) / 6.0;
}

// Along the outward normal, as long as twice the area, mm^2.
inline glm::dvec3 face_vector(const Level& level, const glm::uvec3& face) {
  const glm::dvec3 p(level.vertices[face[0]]);
  return glm::cross(glm::dvec3(level.vertices[face[1]]) - p, glm::dvec3(level.vertices[face[2]]) - p);
}

// mm^2.
inline double face_area(const Level& level, const glm::uvec3& face) {
  return 0.5 * glm::length(face_vector(level, face));
}

// mm, about, from node to node of the tets at the surface.
inline float node_spacing(const Level& level) {
  double area = 0;
  for (const glm::uvec3& face : level.faces) area += face_area(level, face);
  return static_cast<float>(std::sqrt(area / std::max(level.face_count(), 1u)));
}

}  // namespace quadgraph
