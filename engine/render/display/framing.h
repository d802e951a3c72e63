// Where a camera stands that is to show the whole outline of a body.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace quadgraph {

// Share of the picture's half width, or half height, that stays free beside the outline, on both sides of that of the
// two which it fills more.
inline constexpr double outline_margin = 0.12;

// Unit, right-handed.
struct CameraAxes {
  glm::dvec3 right, up, backward;
};

struct OutlineFit {
  glm::dvec2 middle;  // mm to the right and up of the centre: what the middle of the picture shows
  double size;        // mm: from there to the eye; of parallel rays half the height of the picture
};

// slope: tangent of half the vertical field of view, 0: parallel rays. aspect: width / height. upright: the axis about
// which the points, mm, turn through the centre and are to be seen all the time, so that the picture's middle is on it;
// (0, 0, 0) if they stand still.
OutlineFit fit_outline(std::span<const glm::vec3> points, const glm::dvec3& centre, const CameraAxes& axes,
                       double slope, double aspect, const glm::dvec3& upright);

}  // namespace quadgraph
