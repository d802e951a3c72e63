// Ways to deform a body while it is shown: what a user states, in mm and degrees, about the body as it lies in the
// file. docs/deformation.md describes them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/names.h"
#include "engine/file/shapes.h"

namespace quadgraph {

// `placed` is not among the names: it is of bodies that move on their own (body_poses.h).
enum class DeformerKind { twist, bend, taper, stretch, transform, lattice, cage, displaced, placed };

template <>
struct Names<DeformerKind> {
  static constexpr std::string_view what = "deformer";
  static constexpr auto values = std::to_array<Named<DeformerKind>>(
      {{DeformerKind::twist, "twist", "sections across the axis turn about it"},
       {DeformerKind::bend, "bend", "the axis becomes an arc"},
       {DeformerKind::taper, "taper", "sections across the axis are scaled"},
       {DeformerKind::stretch, "stretch", "the body becomes longer along the axis"},
       {DeformerKind::transform, "transform", "scaled, turned and moved"},
       {DeformerKind::lattice, "lattice", "control points in a box are displaced"},
       {DeformerKind::cage, "cage", "the body follows the vertices of a mesh around it"},
       {DeformerKind::displaced, "displaced", "shapes that a file has of every vertex"}});
};

enum class LatticeBasis { bezier, linear };

template <>
struct Names<LatticeBasis> {
  static constexpr std::string_view what = "basis";
  static constexpr auto values = std::to_array<Named<LatticeBasis>>(
      {{LatticeBasis::bezier, "bezier", "of degree size - 1"}, {LatticeBasis::linear, "linear", "between neighbours"}});
};

// Around the display mesh at rest, mm.
struct RestBox {
  glm::dvec3 low{0}, high{0};
};
RestBox rest_box(std::span<const glm::vec3> vertices);

// What a body moves by: turn * p + shift.
struct RigidMove {
  glm::dmat3 turn{1};   // a rotation
  glm::dvec3 shift{0};  // mm

  bool operator==(const RigidMove&) const = default;
};

struct VertexBodies;

// One step of a deformation, which is a list of them, applied in order. Members that a kind does not name are not used.
struct Deformer {
  DeformerKind kind = DeformerKind::twist;

  // twist: the sections across the axis turn about it, by 0 where the range begins to `degrees` where it ends.
  // bend: the range of the axis becomes an arc of `degrees` towards `towards`; what lies before it stays.
  // taper: the sections are scaled about the axis, by 1 where the range begins to `factor` where it ends.
  // stretch: the range becomes `factor` times as long; what lies before it stays.
  // transform: about `centre` scaled along x, y, z, then turned by `degrees` about the axis, then moved.
  glm::dvec3 axis{0, 1, 0};            // of any length but 0
  glm::dvec3 towards{1, 0, 0};         // the same, not along the axis
  std::optional<glm::dvec3> centre{};  // mm, a point of the axis; the middle of the rest box
  double begin = 0, end = 1;           // of the range along the axis, begin < end
  bool range_in_mm = false;            // as coordinates, dot(axis, point); else shares of the rest box
  double degrees = 0;
  double factor = 1;        // > 0
  glm::dvec3 scale{1};      // > 0
  glm::dvec3 translate{0};  // mm

  // lattice: size.x * size.y * size.z control points, x fastest, evenly in the box, each moved by its displacement.
  glm::uvec3 size{2};                         // 1 to 16 a side
  LatticeBasis basis = LatticeBasis::bezier;  // of degree size - 1, or linear between neighbours
  std::vector<glm::dvec3> displacements{};    // mm
  std::optional<RestBox> box{};               // where the lattice lies; the rest box

  // cage: a closed triangle mesh around the body; every point follows its vertices by its mean value coordinates.
  std::vector<glm::dvec3> cage{}, moved{};  // vertices at rest and moved, mm
  std::vector<glm::uvec3> triangles{};      // counter-clockwise from outside

  // displaced: the sum of the shapes' displacements, each times its weight.
  std::shared_ptr<const Shapes> shapes{};
  std::vector<double> weights{};

  // placed: each body by its own motion, by its number.
  std::vector<RigidMove> moves{};
  std::shared_ptr<const VertexBodies> bodies{};

  bool operator==(const Deformer& other) const;
};

// Throws InputError naming the field, what was found and what is allowed.
void check_deformer(const Deformer& deformer);

// Weights of `count` shapes that are the frames of an animation, at a frame that need not be a whole number; before the
// first and after the last frame that frame's shape alone.
std::vector<double> frame_weights(double frame, std::size_t count);

// "twist 90 degrees, stretch x 1.5, cage": in words, without what does not fit into a line.
std::string summary_of(std::span<const Deformer> list);

// Whether it only turns and moves.
bool is_rigid(const Deformer& deformer);

// The first ones, without those at the end that only turn and move the whole.
std::span<const Deformer> without_rigid_end(std::span<const Deformer> list);

// What two lists make of a body differs by at most so much.
enum class ShapeChange {
  whole,   // a rigid motion of all
  bodies,  // a rigid motion of each body
  shape,   // any
};
ShapeChange change_between(std::span<const Deformer> one, std::span<const Deformer> other);

// Whether a list moves every body as a rigid whole.
bool only_moves(std::span<const Deformer> list);

}  // namespace quadgraph
