#include "engine/render/lights.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "engine/graph/error.h"
#include "engine/render/text.h"

namespace quadgraph {
namespace {

constexpr const char* allowed =
    "expected directional:DX,DY,DZ:IRRADIANCE (W/mm^2), point:X,Y,Z:POWER (mm, W) or ambient:IRRADIANCE (W/mm^2), the "
    "last one number or R/G/B";

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

Light parse_light(std::string_view text) {
  const auto parts = split(text, ':');
  const std::string where = "light '" + std::string(text) + "'";
  const bool ambient = parts[0] == "ambient";
  const bool known = ambient || parts[0] == "directional" || parts[0] == "point";
  if (!known || parts.size() != (ambient ? 2 : 3)) throw InputError(where + ": " + allowed);
  Light light;
  light.power = parse_rgb(parts.back(), where + ", power");
  if (ambient) {
    light.kind = LightKind::ambient;
  } else if (parts[0] == "point") {
    light.kind = LightKind::point;
    light.position = parse_triple(parts[1], ',', where + ", position");
  } else {
    const glm::dvec3 direction(parse_triple(parts[1], ',', where + ", direction"));
    const double length = glm::length(direction);
    if (length == 0) throw InputError(where + ", direction: found length 0, expected a direction");
    light.direction = glm::vec3(direction / length);
  }
  check_light(light);
  return light;
}

std::string to_string(const Light& light) {
  if (light.kind == LightKind::ambient) return "ambient:" + rgb_text(light.power);
  return (light.kind == LightKind::point ? "point:" + triple_text(light.position, ',')
                                         : "directional:" + triple_text(light.direction, ',')) +
         ":" + rgb_text(light.power);
}

void check_light(const Light& light) {
  const std::string where = "light '" + to_string(light) + "'";
  if (!finite(light.power) || glm::any(glm::lessThan(light.power, glm::vec3(0)))) {
    throw InputError(where + ", power: expected finite numbers >= 0");
  }
  if (!finite(light.position)) throw InputError(where + ", position: expected finite numbers");
  if (light.kind == LightKind::directional && !(std::abs(glm::length(light.direction) - 1.0f) < 1e-3f)) {
    throw InputError(where + ", direction: expected unit length");
  }
}

}  // namespace quadgraph
