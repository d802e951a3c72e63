#include "engine/scene/json_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/text.h"

namespace quadgraph {
namespace {

constexpr std::size_t shown_characters = 60;

// `key` as a part of a JSON pointer.
std::string escaped(std::string_view key) {
  std::string text;
  for (char c : key) text += c == '~' ? std::string("~0") : c == '/' ? std::string("~1") : std::string(1, c);
  return text;
}

std::string written(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Adds to `text` what `value` looks like, as far as it is shown: however deep a value is nested, every level adds a
// character.
void show(const Json& value, std::string& text) {
  if (!value.is_structured()) {
    text += written(value);
    return;
  }
  text += value.is_array() ? "[" : "{";
  const std::size_t begun = text.size();
  for (const auto& [key, item] : value.items()) {
    if (text.size() > shown_characters) return;
    if (text.size() > begun) text += ",";
    if (value.is_object()) text += written(key) + ":";
    show(item, text);
  }
  text += value.is_array() ? "]" : "}";
}

// Not within a character of UTF-8.
std::string beginning(std::string text) {
  if (text.size() <= shown_characters) return text;
  std::size_t end = shown_characters;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0u) == 0x80u) --end;
  return text.substr(0, end) + "...";
}

}  // namespace

void JsonField::refuse(const std::string& allowed) const {
  std::string found;
  show(*value_, found);
  throw InputError((path_.empty() ? "/" : path_) + ": found " + beginning(std::move(found)) + ", allowed is " +
                   allowed);
}

void JsonField::allow(std::span<const std::string_view> keys) const {
  std::string all;
  for (std::string_view key : keys) all += (all.empty() ? "" : ", ") + std::string(key);
  if (!value_->is_object()) refuse("an object of " + all);
  for (const auto& [key, value] : value_->items()) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    JsonField(value, path_ + "/" + escaped(key)).refuse("nothing of this name; allowed are " + all);
  }
}

std::optional<JsonField> JsonField::find(std::string_view key) const {
  const auto found = value_->find(std::string(key));
  if (found == value_->end()) return std::nullopt;
  return JsonField(*found, path_ + "/" + escaped(key));
}

JsonField JsonField::at(std::string_view key) const {
  const auto found = find(key);
  if (!found) throw InputError(path_ + "/" + escaped(key) + ": found nothing, a value is required");
  return *found;
}

std::vector<JsonField> JsonField::items() const {
  if (!value_->is_array()) refuse("an array");
  std::vector<JsonField> fields;
  for (std::size_t i = 0; i < value_->size(); ++i) fields.emplace_back((*value_)[i], path_ + "/" + std::to_string(i));
  return fields;
}

std::vector<JsonField> JsonField::members(const std::string& allowed) const {
  if (!value_->is_object()) refuse(allowed);
  std::vector<JsonField> fields;
  for (const auto& [key, value] : value_->items()) fields.emplace_back(value, path_ + "/" + escaped(key));
  return fields;
}

double JsonField::number(double low, double high) const {
  const double number = value_->is_number() ? value_->get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (number >= low && number <= high) return number;
  constexpr double all = std::numeric_limits<double>::max();
  if (low == -all && high == all) refuse("a number");
  refuse(high == all ? "a number from " + number_text(low) + " on"
                     : "a number from " + number_text(low) + " to " + number_text(high));
}

double JsonField::number() const {
  return number(-std::numeric_limits<double>::max(), std::numeric_limits<double>::max());
}

float JsonField::real() const {
  constexpr double all = std::numeric_limits<float>::max();
  return static_cast<float>(number(-all, all));
}

std::uint32_t JsonField::whole(std::uint32_t low, std::uint32_t high) const {
  const double number = value_->is_number() ? value_->get<double>() : -1.0;
  if (!(number >= low && number <= high) || number != std::floor(number)) {
    refuse("a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  return static_cast<std::uint32_t>(number);
}

bool JsonField::truth() const {
  if (!value_->is_boolean()) refuse("true or false");
  return value_->get<bool>();
}

std::string JsonField::text() const {
  if (!value_->is_string()) refuse("a text");
  return value_->get<std::string>();
}

glm::vec3 JsonField::triple() const {
  if (!value_->is_array() || value_->size() != 3) refuse("three numbers");
  const auto parts = items();
  return {parts[0].real(), parts[1].real(), parts[2].real()};
}

glm::dvec3 JsonField::precise_triple() const {
  if (!value_->is_array() || value_->size() != 3) refuse("three numbers");
  const auto parts = items();
  return {parts[0].number(), parts[1].number(), parts[2].number()};
}

glm::vec3 JsonField::rgb() const {
  if (value_->is_array()) return triple();
  if (!value_->is_number()) refuse("a number or three, for red, green and blue");
  return glm::vec3(real());
}

Json real_json(float value) {
  return parse_number(number_text(value), "number");
}

Json triple_json(const glm::vec3& value) {
  return {real_json(value.x), real_json(value.y), real_json(value.z)};
}

Json rgb_json(const glm::vec3& value) {
  return value.x == value.y && value.y == value.z ? real_json(value.x) : triple_json(value);
}

}  // namespace quadgraph
