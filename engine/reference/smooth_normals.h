// Normals of the smooth surface at the corners of a level's faces, in double precision;
// shaders/gather/smooth_normals.comp is its twin.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/file/graph.h"

namespace quadgraph {

using CornerNormals = std::array<glm::dvec3, 3>;  // unit

// Unit, between the corners.
glm::dvec3 normal_at(const CornerNormals& corners, const glm::dvec3& barycentric);

// Per face, those at its corners: means over the open faces around a vertex, as far as no crease
// (shaders/shared/creases.h) parts them from the face, weighed so that they are those of the ball where all vertices
// are on one (Max 1999). Of a reflecting face its own.
std::vector<CornerNormals> smooth_normals(const Level& level);

}  // namespace quadgraph
