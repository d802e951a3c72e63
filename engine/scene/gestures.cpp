#include "engine/scene/gestures.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

namespace quadgraph {
namespace {

constexpr float closer = 0.875f;                    // of the distance, or of what is seen
constexpr float nearest = 0.05f, farthest = 40.0f;  // radii

}  // namespace

View orbited(const View& view, const Sphere& bounds, float aspect, float right, float up) {
  View moved = framed(view, bounds, aspect);
  moved.azimuth = std::remainder(moved.azimuth - right, 360.0f);
  moved.elevation = std::clamp(moved.elevation - up, -90.0f, 90.0f);
  return moved;
}

View panned(const View& view, const Sphere& bounds, float aspect, float right, float up) {
  const Camera camera = place_camera(view, bounds, aspect);
  const float height = static_cast<float>(2 * camera.half_height);
  View moved = framed(view, bounds, aspect);
  moved.target -= height * (right * camera.right + up * camera.up);
  const float length = glm::length(moved.target);
  if (length > 2 * bounds.radius) moved.target *= 2 * bounds.radius / length;
  return moved;
}

View zoomed(const View& view, const Sphere& bounds, float aspect, float steps) {
  const Camera camera = place_camera(view, bounds, aspect);
  const double size = camera.parallel ? 2 * camera.half_height : camera.distance;
  const float wanted =
      std::clamp(static_cast<float>(size) * std::pow(closer, steps), nearest * bounds.radius, farthest * bounds.radius);
  View moved = framed(view, bounds, aspect);
  (camera.parallel ? moved.orthographic : moved.distance) = wanted;
  return moved;
}

Light turned(Light light, const View& view, const Sphere& bounds, float right, float up) {
  const Camera camera = place_camera(view, bounds, 1);
  const glm::mat4 turn = glm::rotate(glm::mat4(1), glm::radians(right), camera.up) *
                         glm::rotate(glm::mat4(1), glm::radians(-up), camera.right);
  light.direction = glm::normalize(glm::vec3(turn * glm::vec4(light.direction, 0)));
  light.position = bounds.centre + glm::vec3(turn * glm::vec4(light.position - bounds.centre, 0));
  light.u = glm::vec3(turn * glm::vec4(light.u, 0));
  light.v = glm::vec3(turn * glm::vec4(light.v, 0));
  const LightForm& form = form_of(light.kind);
  if (form.has(FieldForm::top)) light.up = glm::vec3(turn * glm::vec4(light.up, 0));
  if (form.has(FieldForm::turn)) light.turn = std::remainder(light.turn + right, 360.0f);
  return light;
}

Light as_kind(const Light& light, LightKind kind, const Sphere& bounds) {
  const LightForm &old = form_of(light.kind), &form = form_of(kind);
  const glm::vec3 from =
      old.has(FieldForm::point) ? light.position - bounds.centre : -3 * bounds.radius * light.direction;
  const float distance = std::max(glm::length(from), 0.1f * bounds.radius);
  Light result{.kind = kind};
  result.direction = -glm::normalize(from);
  result.position = bounds.centre + from;
  const glm::vec3 side = std::abs(result.direction.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  result.u = bounds.radius * glm::normalize(glm::cross(result.direction, side));
  result.v = glm::cross(result.direction, result.u);
  if (form.has(FieldForm::top)) result.up = side;
  result.power =
      light.power * (form.power_over_irradiance(result, distance) / old.power_over_irradiance(light, distance));
  return result;
}

Light faced(Light rectangle, const glm::vec3& direction, UpAxis up) {
  const glm::vec3 upright = up == UpAxis::z ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
  const glm::vec3 right = glm::normalize(glm::cross(direction, upright));
  rectangle.u = glm::length(rectangle.u) * right;
  rectangle.v = glm::length(rectangle.v) * glm::cross(direction, right);
  return rectangle;
}

BodyCut cut_along(const View& view, const Sphere& bounds, float aspect, const glm::vec2& from, const glm::vec2& to) {
  const Camera camera = place_camera(view, bounds, aspect);
  const ViewRay first = view_ray(camera, from);
  const glm::dvec3 stroke = view_ray(camera, to).through - first.through;
  const glm::dvec3 normal = glm::normalize(glm::cross(first.along, stroke));
  return {.normal = normal, .offset = static_cast<float>(glm::dot(normal, first.through))};
}

Bearing bearing_of(const glm::vec3& towards, UpAxis up) {
  const glm::vec3 y_up = up == UpAxis::y ? towards : glm::vec3(towards.x, towards.z, -towards.y);
  const glm::vec3 unit = glm::normalize(y_up) + glm::vec3(0);  // no -0
  return {glm::degrees(std::atan2(unit.x, unit.z)), glm::degrees(std::asin(std::clamp(unit.y, -1.0f, 1.0f)))};
}

glm::vec3 towards(const Bearing& bearing, UpAxis up) {
  return place_camera({.azimuth = bearing.azimuth, .elevation = bearing.elevation, .up = up}, {{0, 0, 0}, 1}, 1)
      .backward;
}

}  // namespace quadgraph
