#include "engine/scene/light_json.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "engine/render/display/camera.h"

namespace quadgraph {
namespace {

glm::vec3 direction_from(const JsonField& field) {
  const glm::dvec3 direction(field.triple());
  if (glm::length(direction) == 0) field.refuse("a direction");
  return glm::vec3(glm::normalize(direction));
}

glm::vec3 vector_from(FieldForm form, const JsonField& field) {
  if (form == FieldForm::direction) return direction_from(field);
  if (form == FieldForm::power) return field.rgb();
  if (form != FieldForm::axis) return field.triple();
  return field.named<UpAxis>() == UpAxis::y ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
}

void read_field(const LightField& known, const JsonField& field, Light& light) {
  if (const auto* number = std::get_if<float Light::*>(&known.member)) {
    light.** number = field.real();
  } else if (const auto* file = std::get_if<std::string Light::*>(&known.member)) {
    light.** file = field.text();
  } else {
    light.*std::get<glm::vec3 Light::*>(known.member) = vector_from(known.form, field);
  }
}

Json field_json(const LightField& known, const Light& light) {
  if (const auto* number = std::get_if<float Light::*>(&known.member)) return real_json(light.**number);
  if (const auto* file = std::get_if<std::string Light::*>(&known.member)) return light.**file;
  const glm::vec3& vector = light.*std::get<glm::vec3 Light::*>(known.member);
  if (known.form == FieldForm::power) return rgb_json(vector);
  if (known.form == FieldForm::axis) return name_of(vector.z > 0 ? UpAxis::z : UpAxis::y);
  return triple_json(vector);
}

std::string allowed_types() {
  std::string text;
  for (const LightForm& form : light_kinds()) text += (text.empty() ? "" : ", ") + std::string(form.name);
  return text;
}

Light read_form(const LightForm& form, const JsonField& field) {
  std::vector<std::string_view> names{"type"};
  for (const LightField& known : form.fields) names.push_back(known.name);
  field.allow(names);
  Light light;
  light.kind = form.kind;
  for (const LightField& known : form.fields) {
    if (!known.optional) {
      read_field(known, field.at(known.name), light);
    } else if (const auto given = field.find(known.name)) {
      read_field(known, *given, light);
    }
  }
  return light;
}

}  // namespace

Light light_from(const JsonField& field) {
  if (!field.value().is_object()) field.refuse("an object with a type");
  const JsonField type = field.at("type");
  const auto kinds = light_kinds();
  const auto form =
      std::find_if(kinds.begin(), kinds.end(), [name = type.text()](const LightForm& f) { return f.name == name; });
  if (form == kinds.end()) type.refuse(allowed_types());
  const Light light = read_form(*form, field);
  field.within([&] { check_light(light); });
  return light;
}

Json to_json(const Light& light) {
  const LightForm& form = form_of(light.kind);
  Json json{{"type", form.name}};
  for (const LightField& known : form.fields) json[std::string(known.name)] = field_json(known, light);
  return json;
}

}  // namespace quadgraph
