#include "engine/deform/deformer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <map>
#include <string>
#include <utility>

#include "engine/base/error.h"
#include "shaders/deform/deform_shared.h"

namespace quadgraph {
namespace {

// Up to here an angle in single precision moves points to a millionth of the body.
constexpr double most_degrees = 3600;
constexpr double most_factor = 1000;
constexpr double most_mm = 1e6;
constexpr std::size_t most_cage_vertices = 4096;

[[noreturn]] void refuse(const Deformer& deformer, const std::string& field, const std::string& found,
                         const std::string& allowed) {
  throw InputError(std::string(name_of(deformer.kind)) + ", " + field + ": found " + found + ", allowed is " + allowed);
}

std::string text(const glm::dvec3& v) {
  return std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z);
}

bool within(const glm::dvec3& v, double most) {
  return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}

void check_points(const Deformer& deformer, const char* field, std::span<const glm::dvec3> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (within(points[i], most_mm)) continue;
    refuse(deformer, field + std::string(" ") + std::to_string(i), text(points[i]), "finite, at most 1e6 mm");
  }
}

void check_axis(const Deformer& deformer) {
  if (!within(deformer.axis, most_mm) || !(glm::length(deformer.axis) > 1e-9)) {
    refuse(deformer, "axis", text(deformer.axis), "a direction");
  }
  if (deformer.centre && !within(*deformer.centre, most_mm)) {
    refuse(deformer, "centre", text(*deformer.centre), "a point in mm");
  }
  if (!(std::abs(deformer.degrees) <= most_degrees)) {
    refuse(deformer, "degrees", std::to_string(deformer.degrees), "-3600 to 3600");
  }
}

void check_range(const Deformer& deformer) {
  check_axis(deformer);
  const bool finite = std::abs(deformer.begin) <= most_mm && std::abs(deformer.end) <= most_mm;
  if (!finite || !(deformer.end - deformer.begin > 1e-6)) {
    refuse(deformer, "range", std::to_string(deformer.begin) + " to " + std::to_string(deformer.end),
           "two numbers, the second one larger");
  }
  if (!(deformer.factor >= 1 / most_factor && deformer.factor <= most_factor)) {
    refuse(deformer, "factor", std::to_string(deformer.factor), "0.001 to 1000");
  }
  if (deformer.kind != DeformerKind::bend) return;
  const double across = glm::length(glm::cross(deformer.axis, deformer.towards));
  if (!within(deformer.towards, most_mm) ||
      !(across > 1e-6 * glm::length(deformer.axis) * glm::length(deformer.towards))) {
    refuse(deformer, "towards", text(deformer.towards), "a direction that is not along the axis");
  }
}

void check_transform(const Deformer& deformer) {
  check_axis(deformer);
  const bool positive = glm::all(glm::greaterThanEqual(deformer.scale, glm::dvec3(1 / most_factor)));
  if (!positive || !within(deformer.scale, most_factor)) {
    refuse(deformer, "scale", text(deformer.scale), "0.001 to 1000 each");
  }
  if (!within(deformer.translate, most_mm)) refuse(deformer, "translate", text(deformer.translate), "finite mm");
}

void check_lattice(const Deformer& deformer) {
  const glm::uvec3& size = deformer.size;
  for (int k = 0; k < 3; ++k) {
    if (size[k] >= 1 && size[k] <= LATTICE_MOST) continue;
    refuse(deformer, "size", std::to_string(size[k]), "1 to " + std::to_string(LATTICE_MOST) + " points a side");
  }
  const std::size_t wanted = std::size_t{size.x} * size.y * size.z;
  if (deformer.displacements.size() != wanted) {
    refuse(deformer, "displacements", std::to_string(deformer.displacements.size()),
           std::to_string(wanted) + ", one for each control point, x fastest");
  }
  check_points(deformer, "displacements", deformer.displacements);
  if (!deformer.box) return;
  const glm::dvec3 extent = deformer.box->high - deformer.box->low;
  if (!within(extent, most_mm) || !glm::all(glm::greaterThan(extent, glm::dvec3(1e-6)))) {
    refuse(deformer, "box", text(deformer.box->low) + " to " + text(deformer.box->high), "a box with a volume");
  }
}

// Every side of a triangle is that of one other, the other way round.
void check_closed(const Deformer& deformer) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (std::size_t t = 0; t < deformer.triangles.size(); ++t) {
    const glm::uvec3& ids = deformer.triangles[t];
    for (int k = 0; k < 3; ++k) {
      if (ids[k] >= deformer.cage.size() || ids[k] == ids[(k + 1) % 3]) {
        refuse(deformer, "triangles " + std::to_string(t), "vertex " + std::to_string(ids[k]),
               "three of the " + std::to_string(deformer.cage.size()) + " vertices");
      }
      ++sides[{ids[k], ids[(k + 1) % 3]}];
    }
  }
  for (const auto& [side, count] : sides) {
    const auto back = sides.find({side.second, side.first});
    if (count == 1 && back != sides.end() && back->second == 1) continue;
    refuse(deformer, "triangles", "side " + std::to_string(side.first) + "-" + std::to_string(side.second) + " open",
           "a closed mesh, all triangles counter-clockwise from outside");
  }
}

void check_cage(const Deformer& deformer) {
  if (deformer.cage.size() < 4 || deformer.cage.size() > most_cage_vertices) {
    refuse(deformer, "cage", std::to_string(deformer.cage.size()) + " vertices",
           "4 to " + std::to_string(most_cage_vertices));
  }
  if (deformer.moved.size() != deformer.cage.size()) {
    refuse(deformer, "moved", std::to_string(deformer.moved.size()) + " vertices",
           std::to_string(deformer.cage.size()) + ", one for each at rest");
  }
  check_points(deformer, "cage", deformer.cage);
  check_points(deformer, "moved", deformer.moved);
  check_closed(deformer);
}

void check_displaced(const Deformer& deformer) {
  if (!deformer.shapes) refuse(deformer, "shapes", "none", "shapes of this body");
  if (deformer.weights.size() != deformer.shapes->count()) {
    refuse(deformer, "weights", std::to_string(deformer.weights.size()),
           std::to_string(deformer.shapes->count()) + ", one for each shape");
  }
  for (const double weight : deformer.weights) {
    if (!(std::abs(weight) <= most_factor)) refuse(deformer, "weights", std::to_string(weight), "-1000 to 1000");
  }
}

}  // namespace

RestBox rest_box(std::span<const glm::vec3> vertices) {
  RestBox box{glm::dvec3(HUGE_VAL), glm::dvec3(-HUGE_VAL)};
  for (const glm::vec3& p : vertices) {
    box.low = glm::min(box.low, glm::dvec3(p));
    box.high = glm::max(box.high, glm::dvec3(p));
  }
  return box;
}

bool Deformer::operator==(const Deformer& other) const {
  const auto same_box = [](const std::optional<RestBox>& a, const std::optional<RestBox>& b) {
    return a.has_value() == b.has_value() && (!a || (a->low == b->low && a->high == b->high));
  };
  return kind == other.kind && axis == other.axis && towards == other.towards && centre == other.centre &&
         begin == other.begin && end == other.end && range_in_mm == other.range_in_mm && degrees == other.degrees &&
         factor == other.factor && scale == other.scale && translate == other.translate && size == other.size &&
         basis == other.basis && displacements == other.displacements && same_box(box, other.box) &&
         cage == other.cage && moved == other.moved && triangles == other.triangles && shapes == other.shapes &&
         weights == other.weights && moves == other.moves && bodies == other.bodies;
}

void check_deformer(const Deformer& deformer) {
  switch (deformer.kind) {
    case DeformerKind::twist:
    case DeformerKind::bend:
    case DeformerKind::taper:
    case DeformerKind::stretch:
      return check_range(deformer);
    case DeformerKind::transform:
      return check_transform(deformer);
    case DeformerKind::lattice:
      return check_lattice(deformer);
    case DeformerKind::cage:
      return check_cage(deformer);
    case DeformerKind::displaced:
      return check_displaced(deformer);
    case DeformerKind::placed:
      return;  // rigid_moves has
  }
}

std::vector<double> frame_weights(double frame, std::size_t count) {
  std::vector<double> weights(count, 0.0);
  if (count == 0) return weights;
  const double at = std::clamp(frame, 0.0, static_cast<double>(count - 1));
  const auto first = static_cast<std::size_t>(at);
  weights[first] = 1 - (at - static_cast<double>(first));
  if (first + 1 < count) weights[first + 1] = at - static_cast<double>(first);
  return weights;
}

std::string summary_of(std::span<const Deformer> list) {
  std::string text;
  for (const Deformer& d : list) {
    char amount[64] = "";
    const bool turns = d.kind == DeformerKind::twist || d.kind == DeformerKind::bend;
    const bool scales = d.kind == DeformerKind::taper || d.kind == DeformerKind::stretch;
    if (turns) std::snprintf(amount, sizeof(amount), " %g degrees", d.degrees);
    if (scales) std::snprintf(amount, sizeof(amount), " x %g", d.factor);
    const std::string_view name = d.kind == DeformerKind::placed ? "bodies placed" : name_of(d.kind);
    text += (text.empty() ? "" : ", ") + std::string(name) + amount;
  }
  return text;
}

bool is_rigid(const Deformer& deformer) {
  return deformer.kind == DeformerKind::transform && deformer.scale == glm::dvec3(1);
}

std::span<const Deformer> without_rigid_end(std::span<const Deformer> list) {
  while (!list.empty() && is_rigid(list.back())) list = list.first(list.size() - 1);
  return list;
}

ShapeChange change_between(std::span<const Deformer> one, std::span<const Deformer> other) {
  if (std::ranges::equal(without_rigid_end(one), without_rigid_end(other))) return ShapeChange::whole;
  return only_moves(one) && only_moves(other) ? ShapeChange::bodies : ShapeChange::shape;
}

bool only_moves(std::span<const Deformer> list) {
  const auto rest = without_rigid_end(list);
  return rest.empty() || (rest.size() == 1 && rest.front().kind == DeformerKind::placed);
}

}  // namespace quadgraph
