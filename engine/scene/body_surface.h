// The surface of a body as materials are carried onto it: what of it is nearest to a place, how deep that place lies,
// and which way the surface looks there.
#pragma once

#include <array>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "engine/file/graph.h"
#include "engine/optics/nearest_face.h"

namespace quadgraph {

// Of length 1, along z where there is no direction.
inline glm::dvec3 unit(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : glm::dvec3(0, 0, 1);
}

struct SurfacePlace {
  std::uint32_t face = 0;
  glm::dvec3 weights{0};  // of the face's corners, of sum 1
  glm::dvec3 point{0};    // mm, on the surface
  double depth = 0;       // mm below it; negative outside
};

class BodySurface {
 public:
  // The outside faces of the finest level, or what is shown of a body without levels. `body` must outlive it. Throws
  // InputError where there is none.
  explicit BodySurface(const QuadGraph& body);
  BodySurface(const BodySurface&) = delete;
  BodySurface& operator=(const BodySurface&) = delete;

  // `guess`: a face that is thought to be near, for speed.
  SurfacePlace find(const glm::dvec3& point, std::optional<std::uint32_t> guess = {}) const;

  // Unit normals: bent over the faces around, but not over edges sharper than 40 degrees; and over those as well.
  glm::dvec3 creased_normal(const SurfacePlace& place) const;
  glm::dvec3 smooth_normal(const SurfacePlace& place) const;

  const glm::dvec3& low() const { return low_; }  // corners of its box, mm
  const glm::dvec3& high() const { return high_; }
  glm::dvec3 middle() const { return 0.5 * (low_ + high_); }
  double volume() const;  // mm^3
  const Level& level() const { return level_; }

  // Handles: 0 is a ball. Connected pieces of the surface.
  struct Topology {
    long handles = 0;
    std::size_t pieces = 0;
  };
  Topology topology() const;

 private:
  glm::dvec3 pseudo_normal(const SurfacePlace& place) const;
  template <typename Counts>
  glm::dvec3 around(std::uint32_t vertex, const Counts& counts) const;

  Level shown_;  // of a body without levels: vertices and faces alone
  const Level& level_;
  glm::dvec3 low_{0}, high_{0};
  std::vector<glm::dvec3> normals_;           // of the faces, unit
  std::vector<std::uint32_t> begin_, about_;  // faces about vertex v: about_[begin_[v]] ... about_[begin_[v + 1] - 1]
  std::vector<glm::dmat3> corners_;           // of the faces: normals at their corners, bent over what is not sharp
  std::vector<glm::dvec3> smooth_;            // at the vertices, unit
  std::unique_ptr<NearestFace> nearest_;
};

}  // namespace quadgraph
