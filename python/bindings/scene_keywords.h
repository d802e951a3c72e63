// Keyword arguments of Python functions as options of a scene (engine/scene/options.h).
#pragma once

#include <pybind11/pybind11.h>

#include <initializer_list>
#include <string>
#include <string_view>

#include "engine/scene/options.h"

namespace quadgraph::python {

// The scene that keyword arguments of `function` describe, of options of these groups; what is not given is the
// default. Throws TypeError listing the keywords for another, or for a value of another type, and InputError.
Scene scene_of(const char* function, const pybind11::kwargs& given, std::initializer_list<std::string_view> groups);

// A line for each keyword of these groups: its default, what it is and what it allows.
std::string keywords_help(std::initializer_list<std::string_view> groups);

// An option's value as a Python object: None, bool, int, float, str or list of str.
pybind11::object as_object(const OptionValue& value);

}  // namespace quadgraph::python
