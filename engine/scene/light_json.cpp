#include "engine/scene/light_json.h"

#include <glm/geometric.hpp>

namespace quadgraph {
namespace {

// One type of light: how it is read and written, besides its type.
struct Form {
  std::string_view type;
  LightKind kind;
  void (*read)(const JsonField& field, Light& light);
  void (*write)(const Light& light, Json& json);
};

glm::vec3 direction_from(const JsonField& field) {
  const glm::dvec3 direction(field.triple());
  if (glm::length(direction) == 0) field.refuse("a direction");
  return glm::vec3(glm::normalize(direction));
}

void read_directional(const JsonField& field, Light& light) {
  field.allow({"type", "direction", "irradiance"});
  light.direction = direction_from(field.at("direction"));
  light.power = field.at("irradiance").rgb();
}

void write_directional(const Light& light, Json& json) {
  json["direction"] = triple_json(light.direction);
  json["irradiance"] = rgb_json(light.power);
}

void read_point(const JsonField& field, Light& light) {
  field.allow({"type", "position", "power"});
  light.position = field.at("position").triple();
  light.power = field.at("power").rgb();
}

void write_point(const Light& light, Json& json) {
  json["position"] = triple_json(light.position);
  json["power"] = rgb_json(light.power);
}

void read_ambient(const JsonField& field, Light& light) {
  field.allow({"type", "irradiance"});
  light.power = field.at("irradiance").rgb();
}

void write_ambient(const Light& light, Json& json) {
  json["irradiance"] = rgb_json(light.power);
}

void read_spot(const JsonField& field, Light& light) {
  field.allow({"type", "position", "direction", "angle", "edge", "power"});
  light.position = field.at("position").triple();
  light.direction = direction_from(field.at("direction"));
  light.angle = field.at("angle").real();
  if (const auto edge = field.find("edge")) light.edge = edge->real();
  light.power = field.at("power").rgb();
}

void write_spot(const Light& light, Json& json) {
  json["position"] = triple_json(light.position);
  json["direction"] = triple_json(light.direction);
  json["angle"] = real_json(light.angle);
  json["edge"] = real_json(light.edge);
  json["power"] = rgb_json(light.power);
}

void read_rectangle(const JsonField& field, Light& light) {
  field.allow({"type", "centre", "u", "v", "power"});
  light.position = field.at("centre").triple();
  light.u = field.at("u").triple();
  light.v = field.at("v").triple();
  light.power = field.at("power").rgb();
}

void write_rectangle(const Light& light, Json& json) {
  json["centre"] = triple_json(light.position);
  json["u"] = triple_json(light.u);
  json["v"] = triple_json(light.v);
  json["power"] = rgb_json(light.power);
}

void read_projector(const JsonField& field, Light& light) {
  field.allow({"type", "position", "direction", "up", "angle", "file", "power"});
  light.position = field.at("position").triple();
  light.direction = direction_from(field.at("direction"));
  if (const auto up = field.find("up")) light.up = up->triple();
  light.angle = field.at("angle").real();
  light.file = field.at("file").text();
  light.power = field.at("power").rgb();
}

void write_projector(const Light& light, Json& json) {
  json["position"] = triple_json(light.position);
  json["direction"] = triple_json(light.direction);
  json["up"] = triple_json(light.up);
  json["angle"] = real_json(light.angle);
  json["file"] = light.file;
  json["power"] = rgb_json(light.power);
}

void read_environment(const JsonField& field, Light& light) {
  field.allow({"type", "file", "turn", "up", "radiance"});
  light.file = field.at("file").text();
  if (const auto turn = field.find("turn")) light.turn = turn->real();
  if (const auto up = field.find("up")) {
    if (up->text() != "y" && up->text() != "z") up->refuse("y or z");
    light.up = up->text() == "y" ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
  }
  light.power = field.at("radiance").rgb();
}

void write_environment(const Light& light, Json& json) {
  json["file"] = light.file;
  json["turn"] = real_json(light.turn);
  json["up"] = light.up.z > 0 ? "z" : "y";
  json["radiance"] = rgb_json(light.power);
}

constexpr Form forms[] = {{"directional", LightKind::directional, read_directional, write_directional},
                          {"point", LightKind::point, read_point, write_point},
                          {"ambient", LightKind::ambient, read_ambient, write_ambient},
                          {"spot", LightKind::spot, read_spot, write_spot},
                          {"rectangle", LightKind::rectangle, read_rectangle, write_rectangle},
                          {"projector", LightKind::projector, read_projector, write_projector},
                          {"environment", LightKind::environment, read_environment, write_environment}};

std::string allowed_types() {
  std::string text;
  for (const Form& form : forms) text += (text.empty() ? "" : ", ") + std::string(form.type);
  return text;
}

}  // namespace

Light light_from(const JsonField& field) {
  if (!field.value().is_object()) field.refuse("an object with a type");
  const std::string type = field.at("type").text();
  for (const Form& form : forms) {
    if (form.type != type) continue;
    Light light;
    light.kind = form.kind;
    form.read(field, light);
    field.within([&] { check_light(light); });
    return light;
  }
  field.at("type").refuse(allowed_types());
}

Json to_json(const Light& light) {
  Json json;
  for (const Form& form : forms) {
    if (form.kind != light.kind) continue;
    json["type"] = std::string(form.type);
    form.write(light, json);
  }
  return json;
}

}  // namespace quadgraph
