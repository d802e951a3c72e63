// Widgets that the panel has more than one of.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace quadgraph {

// The head of a section; whether it is open. `open`: whether it is at first.
bool section(const char* name, bool open = true);

// A list to choose from, with the label to its right; whether another entry was chosen.
bool choose(const char* label, std::size_t& chosen, std::string_view (*name)(std::size_t), std::size_t count);

// The same over values that name_of knows.
template <typename T, std::size_t n>
bool choose(const char* label, T& value, const std::array<T, n>& all) {
  static const std::array<T, n> values = all;
  std::size_t at = 0;
  while (at + 1 < n && values[at] != value) ++at;
  if (!choose(label, at, [](std::size_t i) { return name_of(values[i]); }, n)) return false;
  value = values[at];
  return true;
}

template <typename T>
bool choose(const char* label, T& value, const std::vector<T>& all) {
  static std::vector<T> values;
  values = all;
  std::size_t at = 0;
  while (at + 1 < values.size() && values[at] != value) ++at;
  if (!choose(label, at, [](std::size_t i) { return name_of(values[i]); }, values.size())) return false;
  value = values[at];
  return true;
}

// A slider; whether it was moved. The format is printf's.
bool slide(const char* label, float& value, float low, float high, const char* format, bool logarithmic = false);

// A dim name and a value after it.
void tell(const char* name, const std::string& value);

// As printf's.
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

// "12.3%", with as many digits as are worth reading.
std::string percent(double share);

// "1.2 GB".
std::string bytes_text(std::uint64_t bytes);

}  // namespace quadgraph
