// A straight way through the tets of a level, by their links, in double precision; shaders/source/tet_ray.glsl is its
// twin.
//
// The ray's point is carried in barycentric coordinates, which pass from tet to tet with the shared corners: rounding
// never takes it out of the mesh. What happens on the way is the caller's business:
//   while (exit = ray.find_exit(direction)).found: use exit; next = ray.leave(exit); at a face stop or turn, else
//   ray.enter(next)
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "engine/file/graph.h"

namespace quadgraph {

class TetRay {
 public:
  struct Corner {
    std::uint32_t vertex = 0;
    glm::dvec3 position{0};  // mm
    double lambda = 0;       // barycentric coordinate of the ray's point
  };

  struct Exit {
    bool found = false;                 // false in a tet so flat that its faces have no side
    std::size_t slot = 0;               // of the corner opposite to the face
    double length = 0;                  // mm, to it
    std::array<double, 4> lambda = {};  // there, by corner; >= 0, summing to 1
  };

  explicit TetRay(const Level& level) : level_(level) {}

  // At a point of outside face f, given in the order of its vertices.
  void start_on_face(std::uint32_t f, const glm::dvec3& barycentric);
  // At vertex v of `tet`. The ray turns around v by steps of length 0 until it is in the tet that `direction` points
  // into.
  void start_at_vertex(std::uint32_t v, std::uint32_t tet);

  // Where the ray leaves the present tet, never through the face by which it came.
  Exit find_exit(const glm::dvec3& direction) const;
  // Moves to the exit and returns what lies across, a tet or tet_count + face. Corner 3 is then opposite to that face.
  std::uint32_t leave(const Exit& exit);
  // Enters the tet across, after `leave`.
  void enter(std::uint32_t next);

  std::uint32_t tet() const { return tet_; }
  const Corner& corner(std::size_t k) const { return corners_[k]; }
  // Unit outward normal of the face opposite to corner 3.
  glm::dvec3 face_normal() const;
  // Quarter of outside face f, opposite to corner 3, that the ray's point is in: of a corner, or 3 in the middle.
  std::uint32_t quarter_of(std::uint32_t f) const;

  // Linear interpolation of values at the vertices, at the present point or at an exit.
  glm::dvec3 at_point(std::span<const glm::dvec3> values) const;
  glm::dvec3 at_exit(std::span<const glm::dvec3> values, const Exit& exit) const;

 private:
  void set(std::size_t k, std::uint32_t vertex, double lambda);

  const Level& level_;
  std::uint32_t tet_ = 0;
  std::size_t ways_out_ = 3;  // corners whose opposite faces the ray may leave by: all 4 at the start from a vertex
  std::array<Corner, 4> corners_;
};

// Direction after reflection by a face with unit normal n.
glm::dvec3 mirrored(const glm::dvec3& direction, const glm::dvec3& n);

}  // namespace quadgraph
