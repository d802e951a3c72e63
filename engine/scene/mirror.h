// Painting on both sides of a body: across a plane through the middle of its box, in the shape at rest.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "engine/base/names.h"
#include "engine/render/display/pick.h"

namespace quadgraph {

// Where the brush touches a body, in its shape at rest.
struct TouchPlace {
  glm::vec3 at{0};             // mm
  glm::vec3 inward{0, 0, -1};  // unit, against the normal
  glm::vec3 upright{0, 1, 0};  // unit, along the surface: what is upwards in the picture
};

inline constexpr float least_sine = 0.1f;  // of the angle between a surface's normal and what is upright on it

// By which axis of the body its sides are told apart.
enum class Mirror { off, x, y, z };

template <>
struct Names<Mirror> {
  static constexpr std::string_view what = "mirror";
  static constexpr auto values = std::to_array<Named<Mirror>>({{Mirror::off, "off", "the side of the pointer alone"},
                                                               {Mirror::x, "x", "across x, too"},
                                                               {Mirror::y, "y", "across y, too"},
                                                               {Mirror::z, "z", "across z, too"}});
};

// What a user calls them, with the axis, in the order of Mirror. `front`: the body's, degrees.
std::array<std::string, 4> mirror_names(float front, UpAxis up);

// `point`, mm, in the mirror through `middle`, which is not off.
glm::vec3 mirrored(const glm::vec3& point, Mirror mirror, const glm::vec3& middle);

// The place on the other side, which `nearest` has found where the point of `place` is in the mirror: the way up there
// is that which is seen in the mirror.
TouchPlace mirrored(const TouchPlace& place, Mirror mirror, const Picked& nearest);

}  // namespace quadgraph
