// The options of a scene: the one table that the command lines, scene files, Python's keyword arguments, help,
// docs/scene.schema.json and docs/scene.md follow. The default of an option is what it has in a Scene{}.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/base/range.h"
#include "engine/scene/scene.h"

namespace quadgraph {

// Nothing: what there is without a value is said in the option's help.
using OptionValue = std::variant<std::monostate, bool, std::uint32_t, double, std::string, std::vector<std::string>>;

enum class OptionKind {
  choice,          // one of the names in `choices`
  share,           // a number, on a command line also in percent
  number,          //
  whole,           // a whole number
  flag,            // --NAME or --no-NAME
  text,            //
  number_or_text,  // a text, which in a scene file may be a number
  texts,           // any number of texts, each with the option's name before it
};

template <>
struct Names<OptionKind> {
  static constexpr std::string_view what = "kind";
  static constexpr auto values =
      std::to_array<Named<OptionKind>>({{OptionKind::choice, "choice", "one of some names"},
                                        {OptionKind::share, "share", "a number, or percent"},
                                        {OptionKind::number, "number", "a number"},
                                        {OptionKind::whole, "whole", "a whole number"},
                                        {OptionKind::flag, "flag", "whether or not"},
                                        {OptionKind::text, "text", "a text"},
                                        {OptionKind::number_or_text, "number or text", "a number or a text"},
                                        {OptionKind::texts, "texts", "any number of texts"}});
};

struct Choice {
  std::string_view name, help;
};

struct SceneOption {
  std::string_view name;       // "path-cells"; of those on command lines --path-cells
  std::string_view member{};   // "/solver/path/cells": where a scene file says it; empty: it does not
  std::string_view keyword{};  // of Engine.solve or Engine.render in Python; empty: of neither
  bool on_command_line = true;
  bool own_form = false;       // a scene file says it in a form of its own, which engine/scene/scene.cpp reads
  std::string_view metavar{};  // what stands for the value in --help
  Range range{};               // of a share, a number or a whole number
  std::string help;            // what it is and, where no value says it, the default

  // What follows is set by OptionTable (engine/scene/option_members.h).
  std::string_view group{};  // heading in --help
  OptionKind kind{};
  std::vector<Choice> choices{};
  std::function<OptionValue(const Scene&)> get{};
  std::function<void(Scene&, const OptionValue&)> set{};  // of the alternative that `kind` has; throws InputError
};

inline constexpr std::string_view scene_group = "Scene", camera_group = "Camera", solver_group = "Solver",
                                  path_group = "Method shortest-path", picture_group = "Picture";

// All, in the order of --help.
std::span<const SceneOption> scene_options();

// Throws InputError naming the option unless there is one of this name.
const SceneOption& option_named(std::string_view name);

// The value that a command line's text has; not for flags and texts, whose texts are values. Throws InputError naming
// the option, what was found and what is allowed.
OptionValue parse_value(const SceneOption& option, std::string_view text);

// The text that parse_value reads back; empty for nothing.
std::string value_text(const OptionValue& value);

// `help`, and for a choice its names with what they mean: what --help shows.
std::string full_help(const SceneOption& option);

// "a whole number from 8 to 150": what is expected of a value.
std::string value_allowed(const SceneOption& option);

}  // namespace quadgraph
