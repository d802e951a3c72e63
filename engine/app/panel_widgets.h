// Widgets that the panel has more than one of.
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/names.h"
#include "engine/base/range.h"
#include "engine/base/text.h"

namespace quadgraph {

// The head of a section; whether it is open. `open`: whether it is at first.
bool section(const char* name, bool open = true);

// A list to choose from, with the label to its right; whether another entry was chosen.
bool choose(const char* label, std::size_t& chosen, const std::vector<std::string_view>& names);

// A list of some or all values of an enum, by their names; whether another one was chosen.
template <HasNames Enum>
bool choose(const char* label, Enum& value, const std::vector<Enum>& values) {
  std::vector<std::string_view> names;
  for (const Enum entry : values) names.push_back(name_of(entry));
  auto at = static_cast<std::size_t>(std::find(values.begin(), values.end(), value) - values.begin());
  if (!choose(label, at, names)) return false;
  value = values[at];
  return true;
}

template <HasNames Enum>
bool choose(const char* label, Enum& value) {
  return choose(label, value, all_values<Enum>());
}

// A slider; whether it was moved. The format is printf's.
bool slide(const char* label, float& value, float low, float high, const char* format, bool logarithmic = false);
bool slide(const char* label, float& value, const Range& range, const char* format);

// A button that shows a linear colour and opens a chooser of it; whether another one was chosen.
bool colour_button(const char* label, glm::vec3& linear);

// A button, beside what was drawn before; whether it was pressed.
bool button(const char* label, bool enabled = true, bool beside = true);

// A dim name and a value after it.
void tell(const char* name, const std::string& value);

// A name as a label shows it, with a capital.
std::string capitalised(std::string_view name);

// "12.3%", with as many digits as are worth reading.
std::string percent(double share);

// "1.2 GB".
std::string bytes_text(std::uint64_t bytes);

}  // namespace quadgraph
