#include "engine/scene/light_json.h"

#include <glm/geometric.hpp>

namespace quadgraph {
namespace {

glm::vec3 direction_from(const JsonField& field) {
  const glm::dvec3 direction(field.triple());
  if (glm::length(direction) == 0) field.refuse("a direction");
  return glm::vec3(glm::normalize(direction));
}

Light typed(const JsonField& field, const std::string& type) {
  if (type == "directional") {
    field.allow({"type", "direction", "irradiance"});
    return {.kind = LightKind::directional,
            .direction = direction_from(field.at("direction")),
            .power = field.at("irradiance").rgb()};
  }
  if (type == "point") {
    field.allow({"type", "position", "power"});
    return {.kind = LightKind::point, .position = field.at("position").triple(), .power = field.at("power").rgb()};
  }
  if (type == "ambient") {
    field.allow({"type", "irradiance"});
    return {.kind = LightKind::ambient, .power = field.at("irradiance").rgb()};
  }
  field.at("type").refuse("directional, point or ambient");
}

}  // namespace

Light light_from(const JsonField& field) {
  if (!field.value().is_object()) field.refuse("an object with a type");
  const Light light = typed(field, field.at("type").text());
  field.within([&] { check_light(light); });
  return light;
}

Json to_json(const Light& light) {
  if (light.kind == LightKind::ambient) return {{"type", "ambient"}, {"irradiance", rgb_json(light.power)}};
  if (light.kind == LightKind::point) {
    return {{"type", "point"}, {"position", triple_json(light.position)}, {"power", rgb_json(light.power)}};
  }
  return {{"type", "directional"}, {"direction", triple_json(light.direction)}, {"irradiance", rgb_json(light.power)}};
}

}  // namespace quadgraph
