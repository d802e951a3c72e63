#include "engine/render/light/lights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>
#include <numbers>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace quadgraph {
namespace {

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// No component is larger than `limit`, or no number.
bool within(const glm::vec3& v, float limit) {
  return std::abs(v.x) <= limit && std::abs(v.y) <= limit && std::abs(v.z) <= limit;
}

// What is expected of a vector that is not, or null.
const char* wrong_vector(FieldForm form, const glm::vec3& v, const Light& light) {
  switch (form) {
    case FieldForm::power:
      return within(v, largest_power) && !glm::any(glm::lessThan(v, glm::vec3(0))) ? nullptr : "numbers from 0 to 1e15";
    case FieldForm::direction:
      return std::abs(glm::length(v) - 1.0f) < 1e-3f ? nullptr : "unit length";
    case FieldForm::axis:
      return v == glm::vec3(0, 1, 0) || v == glm::vec3(0, 0, 1) ? nullptr : "y or z";
    case FieldForm::top:
      return finite(v) && glm::length(glm::cross(light.direction, v)) > 1e-3f * glm::length(v)
                 ? nullptr
                 : "a vector that is not along the direction";
    default:
      return within(v, largest_length) ? nullptr : "numbers of at most 1e9 mm";
  }
}

void check_field(const LightField& field, const Light& light, const std::string& where) {
  const std::string what = where + ", " + std::string(field.name) + ": ";
  if (const auto* number = std::get_if<float Light::*>(&field.member)) {
    const float found = light.**number;
    if (field.range.contains(found)) return;
    const std::string unit = field.unit.empty() ? "" : " " + std::string(field.unit);
    const std::string allowed = field.range == Range{} ? "a finite number" : field.range.text() + unit;
    throw InputError(what + "found " + number_text(found) + ", expected " + allowed);
  }
  if (const auto* file = std::get_if<std::string Light::*>(&field.member)) {
    const std::string& name = light.**file;
    if (!name.empty() && name.find(':') == std::string::npos) return;
    throw InputError(what + "found '" + name + "', expected a name without ':'");
  }
  const glm::vec3& found = light.*std::get<glm::vec3 Light::*>(field.member);
  if (const char* expected = wrong_vector(field.form, found, light)) {
    throw InputError(what + "found " + triple_text(found, ',') + ", expected " + expected);
  }
}

}  // namespace

void check_light(const Light& light) {
  const LightForm& form = form_of(light.kind);
  const std::string where = "light '" + to_string(light) + "'";
  for (const LightField& field : form.fields) check_field(field, light, where);
  if (form.check) form.check(light, where);
}

void check_light_count(std::size_t count) {
  if (count <= most_lights) return;
  throw InputError("lights: found " + std::to_string(count) + ", allowed are at most " + std::to_string(most_lights) +
                   "; leave some out, or show many in the image of an environment");
}

bool has_position(const Light& light) {
  return form_of(light.kind).has(FieldForm::point);
}

bool from_all_around(const Light& light) {
  return light.kind == LightKind::ambient || light.kind == LightKind::environment;
}

SpotCosines spot_cosines(const Light& spot) {
  const float outer = glm::radians(spot.angle);
  // A step over nothing would divide by zero.
  const float inner = std::min((1 - spot.edge) * outer, outer - 1e-3f * outer);
  return {std::cos(inner), std::cos(outer)};
}

glm::vec3 axis_intensity(const Light& spot) {
  const double outer = glm::radians(static_cast<double>(spot.angle));
  const double inner = std::min((1 - static_cast<double>(spot.edge)) * outer, outer - 1e-3 * outer);
  // 2 - cos a - cos b without cancellation, for narrow cones.
  const double sines = 2 * (std::pow(std::sin(inner / 2), 2) + std::pow(std::sin(outer / 2), 2));
  return spot.power / static_cast<float>(std::numbers::pi * sines);
}

}  // namespace quadgraph
