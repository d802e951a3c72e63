// Changes that a user makes to a material: painted with a brush, at a depth, or everywhere.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/names.h"
#include "shaders/material/edits.h"

namespace quadgraph {

// Where a picture lies in a body: in a box of that size, along one direction of which it is seen. Mm, in the shape at
// rest.
struct Placement {
  glm::vec3 centre{0};
  glm::vec3 direction{0, 0, -1};  // in which one looks at the picture; of any length but 0
  glm::vec3 up{0, 1, 0};          // to its top; not along the direction
  glm::vec3 size{0};              // its width and height, and how deep the box is along the direction; > 0

  bool operator==(const Placement&) const = default;
};

// Throws InputError naming the field, what was found and what is allowed.
void check_placement(const Placement& placement);

gpu::ImageBox image_box(const Placement& placement);

enum class EditOperation { multiply, add, set };

template <>
struct Names<EditOperation> {
  static constexpr std::string_view what = "operation";
  static constexpr auto values =
      std::to_array<Named<EditOperation>>({{EditOperation::multiply, "multiply", "times the factor"},
                                           {EditOperation::add, "add", "plus the number, not below zero"},
                                           {EditOperation::set, "set", "the number itself"}});
};

// Where the mirror image of an edit is: of its stroke and of its box, as long as it has these.
struct EditMirror {
  std::vector<glm::vec3> stroke{};       // mm, at rest
  std::optional<Placement> placement{};  // in which pictures are seen in a mirror: left is right

  bool operator==(const EditMirror&) const = default;
};

// Where: all of the body, or what lies within `radius` of the stroke; of that what lies between two depths below the
// surface, and in the box of a placement. Places and depths are those of the shape at rest: an edit moves with the
// body.
struct Edit {
  using Operation = EditOperation;

  Operation operation = Operation::multiply;
  // Factor, 1/mm to add (also below 0), or 1/mm; without one it stays.
  std::optional<glm::vec3> sigma_s_prime{};
  std::optional<glm::vec3> sigma_a{};
  std::vector<glm::vec3> stroke{};  // mm, ends of the segments that the brush went along; none: all
  float radius = 0;                 // mm
  float depth_from = 0, depth_to = std::numeric_limits<float>::max();  // mm
  float softness = 0;                                                  // mm over which the edit fades at its bounds
  std::optional<Placement> placement{};
  // In the placement: coefficients above are those where the image is 1, in between they go with it, channel by
  // channel; the luminance of the mask, up to 1, is how much of the edit arrives.
  std::shared_ptr<const ImagePyramid> image{}, mask{};
  std::optional<EditMirror> mirrored{};  // it is there as well; a place that both reach gets what is more

  // Of layers (engine/optics/edit_layer.h), which set these: how much is left in the end of what this edit does
  // together with those before that it joins, 0 to 1; and whether it joins the one before and those that this joins.
  float opacity = 1;
  bool joins = false;

  bool operator==(const Edit&) const = default;
};

// Throws InputError naming the field, what was found and what is allowed.
void check_edit(const Edit& edit);

// Edits as shaders take them.
struct EditArrays {
  explicit EditArrays(std::span<const Edit> edits);

  // Coefficients after all edits, one after the other, of a place whose own are `optical`, among nodes that lie
  // `spacing` apart, mm: what is finer in an image is taken together.
  gpu::Optical apply(gpu::Optical optical, const glm::vec3& position, float depth, float spacing) const;

  // Whether the depth of a place matters.
  bool wants_depth() const;

  std::vector<gpu::MaterialEdit> edits;
  std::vector<glm::vec3> points;  // of all strokes
  std::vector<glm::vec3> texels;  // of all images
};

}  // namespace quadgraph
