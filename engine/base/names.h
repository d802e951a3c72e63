// Names that users write for the values of an enum, each with what it means: one table per enum, which command lines,
// scene files, the window, Python and error messages read.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/base/closest_name.h"
#include "engine/base/error.h"

namespace quadgraph {

// `help` has no full stop and no capital, so that it can stand behind the name.
template <typename Enum>
struct Named {
  Enum value;
  std::string_view name, help;
};

// To be specialised beside an enum: `what` it is, for messages, and `values`, a std::array of Named<Enum> with every
// value once, in the order in which they are offered.
template <typename Enum>
struct Names;

template <typename Enum>
concept HasNames = requires { Names<Enum>::values.front().name; };

template <HasNames Enum>
constexpr std::string_view name_of(Enum value) {
  for (const Named<Enum>& named : Names<Enum>::values) {
    if (named.value == value) return named.name;
  }
  return {};
}

// Throws InputError listing the allowed names.
template <HasNames Enum>
Enum from_name(std::string_view name) {
  std::string allowed;
  std::vector<std::string_view> names;
  for (const Named<Enum>& named : Names<Enum>::values) {
    if (named.name == name) return named.value;
    allowed += (allowed.empty() ? "" : ", ") + std::string(named.name);
    names.push_back(named.name);
  }
  throw InputError(std::string(Names<Enum>::what) + " '" + std::string(name) + "'" + meant(name, names) +
                   ": allowed are " + allowed);
}

// All values, in the order of the table.
template <HasNames Enum>
std::vector<Enum> all_values() {
  std::vector<Enum> values;
  for (const Named<Enum>& named : Names<Enum>::values) values.push_back(named.value);
  return values;
}

}  // namespace quadgraph
