#include "engine/base/text.h"

#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

template <typename T>
std::string shortest(T value) {
  char digits[64];
  const auto result = std::to_chars(digits, digits + sizeof digits, value);
  return {digits, result.ptr};
}

}  // namespace

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const auto end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

double parse_number(std::string_view text, const std::string& field) {
  double value = 0;
  const char* first = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto result = std::from_chars(first, text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size() || !std::isfinite(value)) {
    throw InputError(field + ": found '" + std::string(text) + "', expected a finite number");
  }
  return value;
}

glm::vec3 parse_triple(std::string_view text, char separator, const std::string& field) {
  const auto parts = split(text, separator);
  if (parts.size() != 3) {
    throw InputError(field + ": found '" + std::string(text) + "', expected three numbers joined by '" + separator +
                     "'");
  }
  return {parse_number(parts[0], field), parse_number(parts[1], field), parse_number(parts[2], field)};
}

glm::vec3 parse_rgb(std::string_view text, const std::string& field) {
  if (text.find('/') == std::string_view::npos) return glm::vec3(static_cast<float>(parse_number(text, field)));
  return parse_triple(text, '/', field);
}

std::string number_text(float value) {
  return shortest(value);
}

std::string number_text(double value) {
  return shortest(value);
}

std::string percent_text(double share) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2g%%", 100 * share);
  return text;
}

std::string triple_text(const glm::vec3& value, char separator) {
  return number_text(value.x) + separator + number_text(value.y) + separator + number_text(value.z);
}

std::string rgb_text(const glm::vec3& value) {
  return value.x == value.y && value.y == value.z ? number_text(value.x) : triple_text(value, '/');
}

std::string formatted(const char* format, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof(text), format, arguments);
  va_end(arguments);
  return text;
}

}  // namespace quadgraph
