// Gathered radiance on the CPU, in double precision: one more transport step, along the view ray into the body
// (docs/physics.md, "Gathered radiance"). The GPU does the same in shaders/gather/gather.glsl.
//
//   L = integral of sigma_s' / (4 pi) (phi + entry exp(-depth)) exp(-tau) ds      W/(mm^2 sr), inside
//
// Along a ray through a tet the integral is exact: phi, entry and depth are linear in it, the coefficients constant.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/reference/operator.h"
#include "engine/reference/smooth_normals.h"
#include "engine/reference/uncollided.h"

namespace quadgraph {

// Fluence at the vertices: of light that has scattered, W/mm^2, and of light that has not.
struct InsideLight {
  std::span<const glm::dvec3> phi;
  const Uncollided& uncollided;
  // Those of smooth_normals, by which rays leave and are mirrored; without any, by the faces' own.
  std::span<const CornerNormals> normals = {};
};

// Where a ray leaves the body, to go on outside.
struct Escape {
  glm::dvec3 share{0};  // of the radiance behind that comes in, this face's transmittance included
  std::uint32_t face = 0;
  glm::dvec3 point{0}, direction{0};  // mm; unit, outside
};

struct Gathered {
  glm::dvec3 radiance{0};  // W/(mm^2 sr), inside
  std::vector<Escape> escapes;
};

// What a ray gathers from the point `barycentric` of open face f along `direction` (unit, inward). It is mirrored at
// reflecting faces and, by the share that the surface keeps inside, at open ones.
Gathered gather(const Level& level, const Problem& problem, const InsideLight& light, std::uint32_t f,
                const glm::dvec3& barycentric, const glm::dvec3& direction);

// The way into the body of a ray that leaves face f along `outside` (unit, away from the face), and what of the
// radiance inside leaves: (1 - R) / eta^2.
struct Inward {
  glm::dvec3 direction{0};  // unit
  double leaves = 0;
};
Inward inward_of(const Level& level, double eta, std::uint32_t f, const glm::dvec3& outside);

// W/(mm^2 sr), radiance of scattered light that leaves along `outside` (unit, away from the face): (1 - R) L / eta^2.
glm::dvec3 gathered_radiance(const Level& level, const Problem& problem, const InsideLight& light, std::uint32_t f,
                             const glm::dvec3& barycentric, const glm::dvec3& outside);

// W/mm^2 per outside face, 0 at reflecting ones: the exitance of the gathered radiance at the centroid of a face, by
// four rays: one at each Gauss node of the outside cosine, their azimuths a quarter turn apart.
std::vector<glm::dvec3> gathered_exitance(const Level& level, const Problem& problem, const InsideLight& light);

}  // namespace quadgraph
