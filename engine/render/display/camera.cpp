#include "engine/render/display/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/render/display/framing.h"

namespace quadgraph {
namespace {

constexpr double margin = 1.02;  // around a sphere that fits the picture

// From y up to the view's axis: z up is y up turned by 90 degrees about x. And back.
glm::dvec3 turned(const glm::dvec3& v, UpAxis up) {
  return up == UpAxis::y ? v : glm::dvec3(v.x, -v.z, v.y);
}
glm::dvec3 turned_back(const glm::dvec3& v, UpAxis up) {
  return up == UpAxis::y ? v : glm::dvec3(v.x, v.z, -v.y);
}

// Angles in radians.
struct Pose {
  double azimuth, elevation;
  std::optional<double> distance;
  glm::dvec3 target;
};

Pose pose_of(const View& view, const Sphere& bounds) {
  Pose pose{glm::radians(double{view.azimuth}), glm::radians(double{view.elevation}), view.distance,
            glm::dvec3(bounds.centre) + glm::dvec3(view.target)};
  if (!view.eye) return pose;
  pose.target = *view.look_at;
  const glm::dvec3 way = turned_back(glm::dvec3(*view.eye) - pose.target, view.up);
  const double level = std::hypot(way.x, way.z);
  if (level > 0) pose.azimuth = std::atan2(way.x, way.z);
  pose.elevation = std::atan2(way.y, level);
  pose.distance = glm::length(way);
  return pose;
}

CameraAxes axes_of(const Pose& pose, UpAxis up) {
  const double sin_a = std::sin(pose.azimuth), cos_a = std::cos(pose.azimuth);
  const double sin_e = std::sin(pose.elevation), cos_e = std::cos(pose.elevation);
  const glm::dvec3 backward = turned({sin_a * cos_e, sin_e, cos_a * cos_e}, up);
  const glm::dvec3 upward = turned({-sin_a * sin_e, cos_e, -cos_a * sin_e}, up);
  return {glm::cross(upward, backward), upward, backward};
}

// Rows of a matrix: what each makes of a place is dot(along, place) + constant.
void set_row(glm::mat4& matrix, int row, const glm::dvec3& along, double constant) {
  for (int column = 0; column < 3; ++column) matrix[column][row] = static_cast<float>(along[column]);
  matrix[3][row] = static_cast<float>(constant);
}

// Sets what takes places to clip space. Depth is fitted to the object and falls from 1 to 0, so that it is finest where
// the eye is, which may all but touch the object. All differences of large numbers are taken here, in double precision.
void set_clip(Camera& camera, const CameraAxes& axes, const Sphere& bounds) {
  const double radius = bounds.radius;
  const double depth = glm::dot(camera.eye - glm::dvec3(bounds.centre), axes.backward);
  const double near = std::max(depth - 1.01 * radius, 1e-6 * radius), far = std::max(depth + 1.01 * radius, 2 * near);
  const bool close = !camera.parallel && glm::distance(camera.eye, glm::dvec3(bounds.centre)) < 2 * radius;
  camera.origin = close ? camera.eye : camera.target;
  const glm::dvec3 eye = camera.eye - glm::dvec3(camera.origin);
  const double scale = camera.parallel ? 1 : camera.distance;
  const double across = scale / camera.half_width, upward = scale / camera.half_height;
  const double falls = (camera.parallel ? 1 : near) / (far - near), ahead = glm::dot(axes.backward, eye);
  set_row(camera.clip_from_offset, 0, across * axes.right, -across * glm::dot(axes.right, eye));
  set_row(camera.clip_from_offset, 1, upward * axes.up, -upward * glm::dot(axes.up, eye));
  set_row(camera.clip_from_offset, 2, falls * axes.backward, falls * (far - ahead));
  if (camera.parallel) {
    set_row(camera.clip_from_offset, 3, glm::dvec3(0), 1);
  } else {
    set_row(camera.clip_from_offset, 3, -axes.backward, ahead);
  }
}

// Where nothing says how far the eye is, of an object whose outline is known.
std::optional<OutlineFit> outline_fit(const View& view, const Pose& pose, const CameraAxes& axes, const Sphere& bounds,
                                      double aspect) {
  const bool placed = view.orthographic ? *view.orthographic > 0 : pose.distance.has_value();
  if (placed || view.eye || !bounds.outline || bounds.outline->empty()) return std::nullopt;
  const double slope = view.orthographic ? 0 : std::tan(0.5 * glm::radians(double{view.vertical_fov}));
  const glm::dvec3 upright = view.framing == Framing::turned ? turned({0, 1, 0}, view.up) : glm::dvec3(0);
  return fit_outline(*bounds.outline, bounds.centre, axes, slope, aspect, upright);
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
  if (view.orthographic) check("orthographic", *view.orthographic, height_range, "mm");
  check("aperture", view.aperture, aperture_range, "mm");
  if (view.focus) check("focus", *view.focus, distance_range, "mm");
  if (view.aperture > 0 && view.orthographic) {
    throw InputError("view, aperture: found " + number_text(view.aperture) +
                     " with orthographic, whose rays are parallel and leave nothing to a lens");
  }
  if (view.eye.has_value() != view.look_at.has_value()) {
    throw InputError(std::string("view: ") + (view.eye ? "look_at" : "eye") +
                     " is missing, eye and look_at go together");
  }
  if (!view.eye) return;
  for (int axis = 0; axis < 3; ++axis) {
    check("eye", (*view.eye)[axis], {}, "mm");
    check("look_at", (*view.look_at)[axis], {}, "mm");
  }
  if (*view.eye == *view.look_at) throw InputError("view: eye and look_at are the same place");
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

std::string place_text(const glm::vec3& place) {
  return number_text(place.x) + "," + number_text(place.y) + "," + number_text(place.z);
}

glm::vec3 parse_place(std::string_view text, const std::string& what) {
  const auto parts = split(text, ',');
  if (parts.size() != 3) throw InputError(what + ": found '" + std::string(text) + "', expected x,y,z (mm)");
  glm::vec3 place(0);
  for (int axis = 0; axis < 3; ++axis) {
    place[axis] = static_cast<float>(parse_number(parts[static_cast<std::size_t>(axis)], what));
  }
  return place;
}

View by_angles(const View& view, const Sphere& bounds) {
  if (!view.eye) return view;
  const Pose pose = pose_of(view, bounds);
  View same = view;
  same.azimuth = static_cast<float>(glm::degrees(pose.azimuth));
  same.elevation = static_cast<float>(glm::degrees(pose.elevation));
  same.distance = static_cast<float>(*pose.distance);
  same.target = glm::vec3(pose.target - glm::dvec3(bounds.centre));
  same.eye.reset();
  same.look_at.reset();
  return same;
}

View framed(const View& view, const Sphere& bounds, float aspect) {
  View same = by_angles(view, bounds);
  const bool fits = view.orthographic ? *view.orthographic == 0 : !same.distance;
  if (!fits) return same;
  const Camera camera = place_camera(view, bounds, aspect);
  same.target = glm::vec3(camera.target - glm::dvec3(bounds.centre));
  if (camera.parallel) {
    same.orthographic = static_cast<float>(2 * camera.half_height);
  } else {
    same.distance = static_cast<float>(camera.distance);
  }
  return same;
}

glm::vec4 Camera::seen_from() const {
  return parallel ? glm::vec4(backward, 0) : glm::vec4(eye, 1);
}

glm::vec2 Camera::slopes() const {
  return parallel ? glm::vec2(0) : glm::vec2(half_width / distance, half_height / distance);
}

ViewRay view_ray(const Camera& camera, const glm::vec2& at) {
  const glm::dvec3 beside =
      camera.half_width * at.x * glm::dvec3(camera.right) + camera.half_height * at.y * glm::dvec3(camera.up);
  const glm::dvec3 through = camera.target + beside;
  if (camera.parallel) return {camera.eye + beside, through, -glm::dvec3(camera.backward)};
  return {camera.eye, through, glm::normalize(through - camera.eye)};
}

Camera moved(const Camera& camera, const glm::dvec2& shift, const glm::dvec2& lens, double focus) {
  const glm::dvec2 half(camera.half_width, camera.half_height);
  const glm::dvec2 sheared = camera.parallel ? glm::dvec2(0) : lens * camera.distance / half;
  const glm::dmat4 rows = glm::transpose(glm::dmat4(camera.clip_from_offset));
  glm::dmat4 after = rows;
  for (int k = 0; k < 2; ++k) {
    after[k] += (shift[k] + sheared[k] / focus) * rows[3];
    after[k].w -= sheared[k];
  }
  Camera there = camera;
  there.clip_from_offset = glm::mat4(glm::transpose(after));
  const auto across = [&](const glm::dvec2& by) {
    return by.x * glm::dvec3(camera.right) + by.y * glm::dvec3(camera.up);
  };
  there.eye += across(lens);
  there.target += across(lens * (1 - camera.distance / focus) - shift * half);
  if (!camera.parallel) there.ahead = glm::vec3((there.target - there.eye) / camera.distance);
  return there;
}

Camera place_camera(const View& view, const Sphere& bounds, float aspect) {
  check_view(view);
  Pose pose = pose_of(view, bounds);
  const CameraAxes axes = axes_of(pose, view.up);
  const auto fit = outline_fit(view, pose, axes, bounds, double{aspect});
  if (fit) pose.target += fit->middle.x * axes.right + fit->middle.y * axes.up;
  const double radius = bounds.radius, narrower = std::min(double{aspect}, 1.0);
  const double slope = std::tan(0.5 * glm::radians(double{view.vertical_fov}));
  Camera camera{.parallel = view.orthographic.has_value(),
                .target = pose.target,
                .right = axes.right,
                .up = axes.up,
                .backward = axes.backward,
                .reach = static_cast<float>(2.1 * radius)};
  if (camera.parallel) {
    const double fitting = fit ? fit->size : margin * radius / narrower;
    camera.half_height = *view.orthographic > 0 ? 0.5 * double{*view.orthographic} : fitting;
    camera.distance = glm::dot(glm::dvec3(bounds.centre) - pose.target, axes.backward) + 2 * radius;
  } else {
    const double fitting = fit ? fit->size : margin * radius / std::sin(std::atan(slope * narrower));
    camera.distance = pose.distance.value_or(fitting);
    camera.half_height = slope * camera.distance;
  }
  camera.half_width = double{aspect} * camera.half_height;
  camera.eye = pose.target + camera.distance * axes.backward;
  camera.ahead = -axes.backward;
  set_clip(camera, axes, bounds);
  return camera;
}

}  // namespace quadgraph
