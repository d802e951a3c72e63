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

void check_spot(const Light& light, const std::string& where) {
  if (!(light.angle > 0 && light.angle <= 90)) {
    throw InputError(where + ", angle: found " + number_text(light.angle) +
                     ", expected more than 0, at most 90 degrees");
  }
  if (!(light.edge >= 0 && light.edge <= 1)) {
    throw InputError(where + ", edge: found " + number_text(light.edge) + ", expected 0 to 1");
  }
}

void check_rectangle(const Light& light, const std::string& where) {
  const float area = glm::length(glm::cross(light.u, light.v));
  if (!finite(light.u) || !finite(light.v) || !(area > 0) || !std::isfinite(area)) {
    throw InputError(where + ": expected two finite edges that are not parallel");
  }
}

void check_file(const Light& light, const std::string& where) {
  if (light.file.empty() || light.file.find(':') != std::string::npos) {
    throw InputError(where + ", file: found '" + light.file + "', expected a name without ':'");
  }
}

void check_projector(const Light& light, const std::string& where) {
  if (!(light.angle > 0 && light.angle < 170)) {
    throw InputError(where + ", angle: found " + number_text(light.angle) +
                     ", expected more than 0, below 170 degrees");
  }
  if (!finite(light.up) || !(glm::length(glm::cross(light.direction, light.up)) > 1e-3f * glm::length(light.up))) {
    throw InputError(where + ", up: found " + triple_text(light.up, ',') +
                     ", expected a vector that is not along the direction");
  }
  check_file(light, where);
}

void check_environment(const Light& light, const std::string& where) {
  if (!std::isfinite(light.turn)) throw InputError(where + ", turn: expected a finite number");
  if (light.up != glm::vec3(0, 1, 0) && light.up != glm::vec3(0, 0, 1)) {
    throw InputError(where + ", up: found " + triple_text(light.up, ',') + ", expected y or z");
  }
  check_file(light, where);
}

}  // namespace

void check_light(const Light& light) {
  const std::string where = "light '" + to_string(light) + "'";
  if (!finite(light.power) || glm::any(glm::lessThan(light.power, glm::vec3(0)))) {
    throw InputError(where + ", power: expected finite numbers >= 0");
  }
  if (!finite(light.position)) throw InputError(where + ", position: expected finite numbers");
  const bool directed =
      light.kind == LightKind::directional || light.kind == LightKind::spot || light.kind == LightKind::projector;
  if (directed && !(std::abs(glm::length(light.direction) - 1.0f) < 1e-3f)) {
    throw InputError(where + ", direction: expected unit length");
  }
  if (light.kind == LightKind::spot) check_spot(light, where);
  if (light.kind == LightKind::rectangle) check_rectangle(light, where);
  if (light.kind == LightKind::projector) check_projector(light, where);
  if (light.kind == LightKind::environment) check_environment(light, where);
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
