// Options as command lines show and take them.
#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/scene/options.h"

namespace quadgraph {
namespace {

[[noreturn]] void refuse(const SceneOption& option, std::string_view found) {
  throw InputError(std::string(option.name) + ": found '" + std::string(found) + "', expected " +
                   value_allowed(option));
}

// A number, or percent.
double parse_share(std::string_view text, const std::string& what) {
  const bool percent = text.ends_with('%');
  if (percent) text.remove_suffix(1);
  return parse_number(text, what) / (percent ? 100 : 1);
}

double parse_in_range(const SceneOption& option, std::string_view text) {
  const std::string what(option.name);
  const double number = option.kind == OptionKind::share ? parse_share(text, what) : parse_number(text, what);
  if (!option.range.contains(number)) refuse(option, text);
  return number;
}

std::string joined_names(const SceneOption& option) {
  std::string names;
  for (const Choice& choice : option.choices) names += (names.empty() ? "" : ", ") + std::string(choice.name);
  return names;
}

}  // namespace

const SceneOption& option_named(std::string_view name) {
  const auto all = scene_options();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SceneOption& o) { return o.name == name; });
  if (found == all.end()) throw InputError("option '" + std::string(name) + "': there is none of this name");
  return *found;
}

OptionValue parse_value(const SceneOption& option, std::string_view text) {
  switch (option.kind) {
    case OptionKind::share:
    case OptionKind::number:
      return parse_in_range(option, text);
    case OptionKind::whole: {
      const double number = parse_in_range(option, text);
      if (number < 0 || number > 4294967295.0 || number != std::floor(number)) refuse(option, text);
      return static_cast<std::uint32_t>(number);
    }
    default:
      return std::string(text);
  }
}

std::string value_text(const OptionValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "yes" : "no";
  if (const auto* whole = std::get_if<std::uint32_t>(&value)) return std::to_string(*whole);
  if (const auto* number = std::get_if<double>(&value)) return number_text(*number);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  std::string all;
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) {
    for (const std::string& text : *texts) all += (all.empty() ? "" : " ") + text;
  }
  return all;
}

std::string full_help(const SceneOption& option) {
  std::string help = option.help;
  for (const Choice& choice : option.choices) {
    help +=
        (&choice == &option.choices.front() ? ". " : "; ") + std::string(choice.name) + ": " + std::string(choice.help);
  }
  return help;
}

std::string value_allowed(const SceneOption& option) {
  const std::string range = option.range == Range{} ? "" : " (" + option.range.text() + ")";
  switch (option.kind) {
    case OptionKind::choice:
      return joined_names(option);
    case OptionKind::share:
      return "a share" + range + ", as a number or in percent";
    case OptionKind::number:
      return "a number" + range;
    case OptionKind::whole:
      return "a whole number" + range;
    default:
      return std::string(option.metavar);
  }
}

}  // namespace quadgraph
