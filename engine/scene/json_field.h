// A value in a JSON document and the way to it, so that every complaint says where it is.
#pragma once

#include <glm/vec3.hpp>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/names.h"

namespace quadgraph {

using Json = nlohmann::ordered_json;

// All of its functions throw InputError "/PATH: found ..., allowed is ..." for another type or value.
class JsonField {
 public:
  // `path`: a JSON pointer (RFC 6901), empty for the whole document. `value` must outlive the field.
  JsonField(const Json& value, std::string path) : value_(&value), path_(std::move(path)) {}

  const Json& value() const { return *value_; }
  const std::string& path() const { return path_; }

  [[noreturn]] void refuse(const std::string& allowed) const;

  // Throws unless this is an object with no other keys.
  void allow(std::span<const std::string_view> keys) const;
  void allow(std::initializer_list<std::string_view> keys) const { allow(std::span(keys.begin(), keys.size())); }

  // A member of an object; `at` throws if it is not there.
  std::optional<JsonField> find(std::string_view key) const;
  JsonField at(std::string_view key) const;

  // The entries of an array.
  std::vector<JsonField> items() const;

  // The members of an object, in order; an error message names `allowed` as what was expected.
  std::vector<JsonField> members(const std::string& allowed) const;

  // Finite, from `low` to `high`.
  double number(double low, double high) const;
  double number() const;
  float real() const;
  std::uint32_t whole(std::uint32_t low, std::uint32_t high) const;
  bool truth() const;
  std::string text() const;
  template <HasNames Enum>
  Enum named() const;  // the value of one of its names
  glm::vec3 triple() const;
  glm::dvec3 precise_triple() const;  // as they stand
  glm::vec3 rgb() const;              // one number or three

  // `read()`, with the path put before the message of an InputError of other code.
  template <typename Read>
  auto within(const Read& read) const {
    try {
      return read();
    } catch (const InputError& error) {
      throw InputError(path_ + ": " + error.what());
    }
  }

 private:
  const Json* value_;
  std::string path_;
};

template <HasNames Enum>
Enum JsonField::named() const {
  const std::string found = text();
  std::string allowed;
  for (const Named<Enum>& named : Names<Enum>::values) {
    if (named.name == found) return named.value;
    allowed += (allowed.empty() ? "" : ", ") + std::string(named.name);
  }
  refuse(allowed);
}

// [x, y, z], in the shortest numbers that read back the same.
Json triple_json(const glm::vec3& value);

// One number where all are the same.
Json rgb_json(const glm::vec3& value);

// The shortest number that reads back as the same float.
Json real_json(float value);

}  // namespace quadgraph
