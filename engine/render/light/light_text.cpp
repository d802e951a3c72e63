// Lights as text.
#include <algorithm>
#include <glm/geometric.hpp>

#include "engine/base/closest_name.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/render/display/camera.h"
#include "engine/render/light/lights.h"
#include "engine/render/light/studio.h"

namespace quadgraph {
namespace {

using Parts = std::vector<std::string_view>;

glm::vec3 parse_direction(std::string_view text, const std::string& what) {
  const glm::dvec3 direction(parse_triple(text, ',', what));
  const double length = glm::length(direction);
  if (length == 0) throw InputError(what + ": found length 0, expected a direction");
  return glm::vec3(direction / length);
}

glm::vec3 parse_vector(FieldForm form, std::string_view text, const std::string& what) {
  if (form == FieldForm::direction) return parse_direction(text, what);
  if (form == FieldForm::power) return parse_rgb(text, what);
  if (form != FieldForm::axis) return parse_triple(text, ',', what);
  if (text == name_of(UpAxis::y)) return {0, 1, 0};
  if (text == name_of(UpAxis::z)) return {0, 0, 1};
  throw InputError(what + ": found '" + std::string(text) + "', expected y or z");
}

void parse_field(const LightField& field, std::string_view text, const std::string& where, Light& light) {
  const std::string what = where + ", " + std::string(field.name);
  if (const auto* number = std::get_if<float Light::*>(&field.member)) {
    light.** number = static_cast<float>(parse_number(text, what));
  } else if (const auto* file = std::get_if<std::string Light::*>(&field.member)) {
    light.** file = text;
  } else {
    light.*std::get<glm::vec3 Light::*>(field.member) = parse_vector(field.form, text, what);
  }
}

std::string field_text(const LightField& field, const Light& light) {
  if (const auto* number = std::get_if<float Light::*>(&field.member)) return number_text(light.**number);
  if (const auto* file = std::get_if<std::string Light::*>(&field.member)) return light.**file;
  const glm::vec3& vector = light.*std::get<glm::vec3 Light::*>(field.member);
  if (field.form == FieldForm::power) return rgb_text(vector);
  if (field.form == FieldForm::axis) return std::string(name_of(vector.z > 0 ? UpAxis::z : UpAxis::y));
  return triple_text(vector, ',');
}

std::size_t parts_of(const LightForm& form) {
  std::size_t count = 1;
  for (const LightField& field : form.fields) count += field.joined ? 0 : 1;
  return count;
}

// A field and, in the same part of the text, the one that is joined to it, which may be missing.
void parse_pair(const LightField& field, const LightField& joined, std::string_view text, const std::string& where,
                Light& light) {
  const std::size_t comma = text.find(',');
  parse_field(field, text.substr(0, comma), where, light);
  if (comma != std::string_view::npos) parse_field(joined, text.substr(comma + 1), where, light);
}

Light parse_form(const LightForm& form, const Parts& parts, const std::string& where) {
  Light light;
  light.kind = form.kind;
  std::size_t part = 1;
  for (std::size_t i = 0; i < form.fields.size(); ++i, ++part) {
    const bool pair = i + 1 < form.fields.size() && form.fields[i + 1].joined;
    if (pair) {
      parse_pair(form.fields[i], form.fields[i + 1], parts[part], where, light);
      ++i;
    } else {
      parse_field(form.fields[i], parts[part], where, light);
    }
  }
  return light;
}

}  // namespace

std::string text_form(const LightForm& form) {
  std::string text(form.name);
  for (const LightField& field : form.fields) {
    text += field.joined ? "[," + std::string(field.text) + "]" : ":" + std::string(field.text);
  }
  return text;
}

std::string default_text(const LightField& field) {
  return field.optional ? field_text(field, Light{}) : std::string();
}

const std::string& light_forms() {
  static const std::string all = [] {
    std::string text;
    for (const LightForm& form : light_kinds()) {
      text += text_form(form) + " (" + std::string(form.help);
      for (const LightField& field : form.fields) {
        text += "; " + std::string(field.text) + " " + std::string(field.help);
        if (!field.unit.empty()) text += ", " + std::string(field.unit);
      }
      text += "), ";
    }
    return text + std::string(studio_name) + " (" + std::string(studio_light) + "), the last one number or R/G/B";
  }();
  return all;
}

Light parse_light(std::string_view text) {
  if (text == studio_name) return parse_light(studio_light);
  const Parts parts = split(text, ':');
  const std::string where = "light '" + std::string(text) + "'";
  for (const LightForm& form : light_kinds()) {
    if (form.name != parts[0] || parts_of(form) != parts.size()) continue;
    const Light light = parse_form(form, parts, where);
    check_light(light);
    return light;
  }
  std::string forms;
  std::vector<std::string_view> names;
  for (const LightForm& form : light_kinds()) {
    forms += text_form(form) + ", ";
    names.push_back(form.name);
  }
  const bool known = std::find(names.begin(), names.end(), parts[0]) != names.end();
  throw InputError(where + (known ? "" : meant(parts[0], names)) + ": expected " + forms +
                   "the last one number or R/G/B (docs/lights.md)");
}

std::string to_string(const Light& light) {
  const LightForm& form = form_of(light.kind);
  std::string text(form.name);
  for (const LightField& field : form.fields) text += (field.joined ? "," : ":") + field_text(field, light);
  return text;
}

}  // namespace quadgraph
