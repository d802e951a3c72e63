// The options of a scene and the kinds of light, for command lines, checks and documents.
#include <pybind11/stl.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/scene/measured_error.h"
#include "python/bindings/bindings.h"
#include "python/bindings/scene_keywords.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

bool takes(const SceneOption& option, std::initializer_list<std::string_view> groups) {
  return !option.keyword.empty() && std::find(groups.begin(), groups.end(), option.group) != groups.end();
}

std::string keywords(std::initializer_list<std::string_view> groups) {
  std::string all;
  for (const SceneOption& option : scene_options()) {
    if (takes(option, groups)) all += (all.empty() ? "" : ", ") + std::string(option.keyword);
  }
  return all;
}

OptionValue value_from(const SceneOption& option, py::handle value) {
  switch (option.kind) {
    case OptionKind::flag:
      return py::cast<bool>(value);
    case OptionKind::whole:
      return py::cast<std::uint32_t>(value);
    case OptionKind::share:
    case OptionKind::number:
      return py::cast<double>(value);
    case OptionKind::number_or_text:
      return py::isinstance<py::str>(value) ? OptionValue(py::cast<std::string>(value))
                                            : OptionValue(py::cast<double>(value));
    case OptionKind::texts:
      return py::cast<std::vector<std::string>>(value);
    default:
      return py::cast<std::string>(value);
  }
}

py::object end_of(bool there, double end) {
  return there ? py::object(py::float_(end)) : py::object(py::none());
}

// low and high, None where there is no end, and whether each is itself not allowed.
py::tuple range_tuple(const Range& range) {
  return py::make_tuple(end_of(range.has_low(), range.low), end_of(range.has_high(), range.high), range.above,
                        range.below);
}

void bind_option(py::module_& module) {
  py::class_<SceneOption>(module, "SceneOption",
                          "An option of a scene: of command lines, scene files and keyword arguments alike.")
      .def_readonly("name", &SceneOption::name, "On command lines --NAME.")
      .def_readonly("member", &SceneOption::member, "JSON pointer into a scene file, '' if it is not in there.")
      .def_readonly("keyword", &SceneOption::keyword, "Of Engine.solve or Engine.render, '' if of neither.")
      .def_readonly("group", &SceneOption::group, "Heading in --help.")
      .def_readonly("metavar", &SceneOption::metavar)
      .def_readonly("on_command_line", &SceneOption::on_command_line)
      .def_readonly("own_form", &SceneOption::own_form, "Whether a scene file says it in another form.")
      .def_property_readonly("kind", [](const SceneOption& option) { return name_of(option.kind); })
      .def_property_readonly(
          "choices",
          [](const SceneOption& option) {
            py::dict choices;
            for (const Choice& choice : option.choices) choices[py::str(choice.name)] = choice.help;
            return choices;
          },
          "Allowed names and what each means; empty if it is no choice.")
      .def_property_readonly(
          "range", [](const SceneOption& option) { return range_tuple(option.range); },
          "low, high (None: no end), low excluded, high excluded.")
      .def_property_readonly(
          "default", [](const SceneOption& option) { return as_object(option.get(Scene{})); },
          "None: `help` says what there is then.")
      .def_property_readonly("default_text", [](const SceneOption& option) { return value_text(option.get(Scene{})); })
      .def_readonly("help", &SceneOption::help)
      .def_property_readonly("full_help", &full_help, "With the choices.")
      .def_property_readonly("allowed", &value_allowed)
      .def(
          "parse",
          [](const SceneOption& option, std::string_view text) { return as_object(parse_value(option, text)); },
          py::arg("text"), "The value of a command line's text. Raises InputError.");
}

void bind_light_kind(py::module_& module) {
  py::class_<LightField>(module, "LightField", "A member of lights of one kind.")
      .def_readonly("name", &LightField::name, "In scene files.")
      .def_readonly("text", &LightField::text, "What stands for it in the text form.")
      .def_readonly("unit", &LightField::unit)
      .def_readonly("help", &LightField::help)
      .def_readonly("optional", &LightField::optional, "Whether a scene file may leave it out.")
      .def_property_readonly("form", [](const LightField& field) { return name_of(field.form); })
      .def_property_readonly("default", &default_text, "As a text, '' if the field is required.")
      .def_property_readonly(
          "range", [](const LightField& field) { return range_tuple(field.range); },
          "low, high (None: no end), low excluded, high excluded.");
  py::class_<LightForm>(module, "LightKind", "A kind of light.")
      .def_readonly("name", &LightForm::name)
      .def_readonly("help", &LightForm::help)
      .def_readonly("fields", &LightForm::fields)
      .def_property_readonly("text", &text_form, "What --light takes.");
}

}  // namespace

Scene scene_of(const char* function, const py::kwargs& given, std::initializer_list<std::string_view> groups) {
  Scene scene;
  const auto options = scene_options();
  for (const auto& [key, value] : given) {
    const auto name = py::cast<std::string>(key);
    const auto option = std::find_if(options.begin(), options.end(),
                                     [&](const SceneOption& o) { return takes(o, groups) && o.keyword == name; });
    const std::string where = std::string(function) + "(), " + name + ": ";
    if (option == options.end()) throw py::type_error(where + "no such keyword; allowed are " + keywords(groups));
    try {
      option->set(scene, value_from(*option, value));
    } catch (const py::cast_error&) {
      throw py::type_error(where + "found " + py::cast<std::string>(py::repr(value)) + ", expected " +
                           value_allowed(*option));
    }
  }
  return scene;
}

std::string keywords_help(std::initializer_list<std::string_view> groups) {
  std::string help;
  for (const SceneOption& option : scene_options()) {
    if (!takes(option, groups)) continue;
    const std::string usual = value_text(option.get(Scene{}));
    help += "\n" + std::string(option.keyword) + (usual.empty() ? "" : " = " + usual) + ": " + full_help(option) + ".";
  }
  return help;
}

py::object as_object(const OptionValue& value) {
  return std::visit(
      [](const auto& alternative) -> py::object {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(alternative)>, std::monostate>) {
          return py::none();
        } else {
          return py::cast(alternative);
        }
      },
      value);
}

void bind_options(py::module_& module) {
  bind_option(module);
  bind_light_kind(module);
  module.attr("MEASURED_SHARE") = usual_measured_share;
  module.def(
      "scene_options",
      [] {
        const auto options = scene_options();
        return std::vector<SceneOption>(options.begin(), options.end());
      },
      "All options of a scene, in the order of --help.");
  module.def(
      "light_kinds",
      [] {
        const auto kinds = light_kinds();
        return std::vector<LightForm>(kinds.begin(), kinds.end());
      },
      "All kinds of light, in the order in which they are offered.");
}

}  // namespace quadgraph::python
