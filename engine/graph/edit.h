// Changes that a user makes to a material: painted with a brush, at a depth, or everywhere.
#pragma once

#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "shaders/edits.h"

namespace quadgraph {

// Where: all of the body, or what lies within `radius` of the stroke; of that what lies between two depths below the
// surface. Places and depths are those of the shape at rest: an edit moves with the body.
struct Edit {
  enum class Operation { multiply, add, set };

  Operation operation = Operation::multiply;
  // Factor, 1/mm to add (also below 0), or 1/mm; without one it stays.
  std::optional<glm::vec3> sigma_s_prime{};
  std::optional<glm::vec3> sigma_a{};
  std::vector<glm::vec3> stroke{};  // mm, ends of the segments that the brush went along; none: all
  float radius = 0;                 // mm
  float depth_from = 0, depth_to = std::numeric_limits<float>::max();  // mm
  float softness = 0;                                                  // mm over which the edit fades at its bounds

  bool operator==(const Edit&) const = default;
};

// Throws InputError naming the field, what was found and what is allowed.
void check_edit(const Edit& edit);

// Edits as shaders take them.
struct EditArrays {
  explicit EditArrays(std::span<const Edit> edits);

  // Coefficients after all edits, one after the other, of a place whose own are `optical`.
  gpu::Optical apply(gpu::Optical optical, const glm::vec3& position, float depth) const;

  // Whether the depth of a place matters.
  bool wants_depth() const;

  std::vector<gpu::MaterialEdit> edits;
  std::vector<glm::vec3> points;  // of all strokes
};

}  // namespace quadgraph
