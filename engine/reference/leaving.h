// Light that leaves a body along a view ray, with what is seen through it, on the CPU in double precision;
// shaders/gather/leaving.glsl is its twin.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "engine/reference/gather_scale.h"
#include "engine/reference/radiance.h"

namespace quadgraph {

struct LeavingLight {
  glm::dvec3 radiance{0};  // W/(mm^2 sr)
  glm::dvec3 seen{0};      // share of the light behind all parts of the body that comes through
};

// From the point `barycentric` of open face f along `outside` (unit, away from the face): gathered radiance, scaled,
// and what the ray gathers in the parts of the body that lie behind, where more than GATHER_END of it comes out again.
LeavingLight leaving(const Level& level, const Problem& problem, const InsideLight& light,
                     std::span<const VertexScale> scale, std::uint32_t f, glm::dvec3 barycentric, glm::dvec3 outside);

}  // namespace quadgraph
