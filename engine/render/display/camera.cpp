#include "engine/render/display/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace quadgraph {
namespace {

// From y up to the view's axis: z up is y up turned by 90 degrees about x.
glm::vec3 turned(const glm::vec3& v, UpAxis up) {
  return up == UpAxis::y ? v : glm::vec3(v.x, -v.z, v.y);
}

}  // namespace

View first_view(float front, UpAxis up) {
  return {.azimuth = up == UpAxis::y ? front : 0, .up = up};
}

void check_view(const View& view) {
  const auto check = [](const char* field, float found, const Range& allowed, const char* unit) {
    if (allowed.contains(found)) return;
    const std::string expected = allowed == Range{} ? "a finite number of" : allowed.text();
    throw InputError(std::string("view, ") + field + ": found " + number_text(found) + ", expected " + expected + " " +
                     unit);
  };
  check("azimuth", view.azimuth, {}, "degrees");
  check("elevation", view.elevation, elevation_range, "degrees");
  check("field of view", view.vertical_fov, fov_range, "degrees");
  for (int axis = 0; axis < 3; ++axis) check("target", view.target[axis], {}, "mm");
  if (view.distance) check("distance", *view.distance, distance_range, "mm");
}

Sphere bounding_sphere(std::span<const glm::vec3> points) {
  if (points.empty()) return {};
  glm::vec3 low = points[0], high = points[0];
  for (const glm::vec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  Sphere sphere{0.5f * (low + high), 0};
  for (const glm::vec3& p : points) sphere.radius = std::max(sphere.radius, glm::distance(p, sphere.centre));
  return sphere;
}

View parse_view(std::string_view text, View rest) {
  const auto parts = split(text, ',');
  if (parts.size() != 2 && parts.size() != 3) {
    throw InputError("view: found '" + std::string(text) +
                     "', expected azimuth,elevation or azimuth,elevation,distance (degrees, degrees, mm)");
  }
  rest.azimuth = static_cast<float>(parse_number(parts[0], "view, azimuth"));
  rest.elevation = static_cast<float>(parse_number(parts[1], "view, elevation"));
  if (parts.size() == 3) rest.distance = static_cast<float>(parse_number(parts[2], "view, distance"));
  check_view(rest);
  return rest;
}

std::string to_string(const View& view) {
  return number_text(view.azimuth) + "," + number_text(view.elevation) +
         (view.distance ? "," + number_text(*view.distance) : "");
}

Camera place_camera(const View& view, const Sphere& bounds, float aspect) {
  check_view(view);
  const float azimuth = glm::radians(view.azimuth), elevation = glm::radians(view.elevation);
  const float half_height = std::tan(0.5f * glm::radians(view.vertical_fov));
  const float narrow = std::atan(half_height * std::min(aspect, 1.0f));
  const float distance = view.distance.value_or(1.02f * bounds.radius / std::sin(narrow));

  Camera camera;
  camera.backward = turned(
      {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)}, view.up);
  camera.up =
      turned({-std::sin(azimuth) * std::sin(elevation), std::cos(elevation), -std::cos(azimuth) * std::sin(elevation)},
             view.up);
  camera.right = glm::cross(camera.up, camera.backward);
  camera.eye = bounds.centre + view.target + distance * camera.backward;

  const float depth = distance + glm::dot(view.target, camera.backward);
  const float near = std::max(depth - 1.01f * bounds.radius, 1e-3f * bounds.radius);
  const float far = std::max(depth + 1.01f * bounds.radius, 2 * near);
  camera.clip_from_world = glm::perspectiveRH_ZO(glm::radians(view.vertical_fov), aspect, near, far) *
                           glm::lookAtRH(camera.eye, camera.eye - camera.backward, camera.up);
  return camera;
}

}  // namespace quadgraph
