#include "engine/app/gestures.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace quadgraph {
namespace {

constexpr float step = 0.875f;                      // of the distance
constexpr float nearest = 0.05f, farthest = 40.0f;  // radii

float distance_of(const View& view, const Sphere& bounds, float aspect) {
  return glm::distance(place_camera(view, bounds, aspect).eye, bounds.centre + view.target);
}

}  // namespace

View orbited(View view, float right, float up) {
  view.azimuth = std::remainder(view.azimuth - right, 360.0f);
  view.elevation = std::clamp(view.elevation - up, -90.0f, 90.0f);
  return view;
}

View panned(View view, const Sphere& bounds, float aspect, float right, float up) {
  const Camera camera = place_camera(view, bounds, aspect);
  const float height = 2 * distance_of(view, bounds, aspect) * std::tan(0.5f * glm::radians(view.vertical_fov));
  view.target -= height * (right * camera.right + up * camera.up);
  const float length = glm::length(view.target);
  if (length > 2 * bounds.radius) view.target *= 2 * bounds.radius / length;
  return view;
}

View zoomed(View view, const Sphere& bounds, float aspect, float steps) {
  view.distance = std::clamp(distance_of(view, bounds, aspect) * std::pow(step, steps), nearest * bounds.radius,
                             farthest * bounds.radius);
  return view;
}

Light turned(Light light, const View& view, const Sphere& bounds, float right, float up) {
  const Camera camera = place_camera(view, bounds, 1);
  const glm::mat4 turn = glm::rotate(glm::mat4(1), glm::radians(right), camera.up) *
                         glm::rotate(glm::mat4(1), glm::radians(-up), camera.right);
  light.direction = glm::normalize(glm::vec3(turn * glm::vec4(light.direction, 0)));
  light.position = bounds.centre + glm::vec3(turn * glm::vec4(light.position - bounds.centre, 0));
  return light;
}

Bearing bearing_of(const glm::vec3& towards, UpAxis up) {
  const glm::vec3 y_up = up == UpAxis::y ? towards : glm::vec3(towards.x, towards.z, -towards.y);
  const glm::vec3 unit = glm::normalize(y_up);
  return {glm::degrees(std::atan2(unit.x, unit.z)), glm::degrees(std::asin(std::clamp(unit.y, -1.0f, 1.0f)))};
}

glm::vec3 towards(const Bearing& bearing, UpAxis up) {
  return place_camera({.azimuth = bearing.azimuth, .elevation = bearing.elevation, .up = up}, {{0, 0, 0}, 1}, 1)
      .backward;
}

}  // namespace quadgraph
