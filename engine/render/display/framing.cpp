#include "engine/render/display/framing.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

namespace quadgraph {
namespace {

constexpr int turns = 24;  // between two of them an outline grows by less than a tenth of the margin

// How far points reach to the four sides of a picture, mm: of planes that lean by `slopes` towards the eye, where they
// cross the plane through the centre. And how near they come to the eye.
struct Extent {
  double right, left, up, down, near;

  static Extent none() {
    constexpr double least = -std::numeric_limits<double>::infinity();
    return {least, least, least, least, least};
  }

  void add(const Extent& other) {
    right = std::max(right, other.right);
    left = std::max(left, other.left);
    up = std::max(up, other.up);
    down = std::max(down, other.down);
    near = std::max(near, other.near);
  }
};

Extent extent_of(std::span<const glm::vec3> points, const glm::dvec3& centre, const CameraAxes& axes,
                 const glm::dvec2& slopes) {
  Extent extent = Extent::none();
  for (const glm::vec3& point : points) {
    const glm::dvec3 from = glm::dvec3(point) - centre;
    const double x = glm::dot(from, axes.right), y = glm::dot(from, axes.up), z = glm::dot(from, axes.backward);
    extent.add({x + slopes.x * z, slopes.x * z - x, y + slopes.y * z, slopes.y * z - y, z});
  }
  return extent;
}

Extent turned_extent(std::span<const glm::vec3> points, const glm::dvec3& centre, const CameraAxes& axes,
                     const glm::dvec2& slopes, const glm::dvec3& upright) {
  Extent extent = Extent::none();
  for (int k = 0; k < turns; ++k) {
    const glm::dmat3 turn(glm::rotate(glm::dmat4(1), 2 * std::numbers::pi * k / turns, upright));
    const CameraAxes there{turn * axes.right, turn * axes.up, turn * axes.backward};
    extent.add(extent_of(points, centre, there, slopes));
  }
  extent.right = extent.left = std::max(extent.right, extent.left);
  return extent;
}

}  // namespace

// The four planes through the eye that bound the picture touch the body, or two of them that face each other do.
OutlineFit fit_outline(std::span<const glm::vec3> points, const glm::dvec3& centre, const CameraAxes& axes,
                       double slope, double aspect, const glm::dvec3& upright) {
  const bool parallel = slope == 0, turning = upright != glm::dvec3(0);
  const double filled = 1 - outline_margin;
  const glm::dvec2 slopes = filled * slope * glm::dvec2(aspect, 1);
  const Extent extent =
      turning ? turned_extent(points, centre, axes, slopes, upright) : extent_of(points, centre, axes, slopes);
  const glm::dvec2 middle(0.5 * (extent.right - extent.left), 0.5 * (extent.up - extent.down));
  const double across = 0.5 * (extent.right + extent.left), upward = 0.5 * (extent.up + extent.down);
  constexpr double least = 1e-6;  // mm; of a body that is a point
  if (parallel) return {middle, std::max({across / (filled * aspect), upward / filled, least})};
  return {middle, std::max({across / slopes.x, upward / slopes.y, extent.near + least})};
}

}  // namespace quadgraph
