// The table of scene options: that command lines and scene files can say each, and that its facts are the engine's.
#include "engine/scene/options.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/base/error.h"

using namespace quadgraph;

namespace {

// A scene file that says `value` for an option, with a method that knows it.
Json document_with(const SceneOption& option, const Json& value) {
  const Method method = option.name == "active-layers" ? Method::polygrid : Method::fem;
  Json document{{"body", "a.qgraph"}, {"solver", {{"method", name_of(method)}}}};
  document[Json::json_pointer(std::string(option.member))] = value;
  return document;
}

bool accepted(const SceneOption& option, double value) {
  const Json document =
      document_with(option, option.kind == OptionKind::whole ? Json(static_cast<std::int64_t>(value)) : Json(value));
  try {
    scene_from(JsonField(document, ""));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

bool in_file(const SceneOption& option) {
  return !option.member.empty() && !option.own_form;
}

}  // namespace

TEST_CASE("every option has one name, one place in a file and one keyword") {
  std::set<std::string_view> names, members, keywords;
  for (const SceneOption& option : scene_options()) {
    CAPTURE(option.name);
    CHECK(names.insert(option.name).second);
    if (in_file(option)) CHECK(members.insert(option.member).second);
    if (!option.keyword.empty()) CHECK(keywords.insert(option.keyword).second);
    CHECK((option.on_command_line || !option.member.empty() || !option.keyword.empty()));
    CHECK_FALSE(option.help.empty());
    CHECK(&option_named(option.name) == &option);
  }
  CHECK_THROWS_WITH_AS(option_named("zoom"), doctest::Contains("'zoom'"), InputError);
}

TEST_CASE("the defaults of the table are those of a scene, as texts too") {
  for (const SceneOption& option : scene_options()) {
    CAPTURE(option.name);
    const OptionValue value = option.get(Scene{});
    if (value.index() == 0) continue;
    Scene scene;
    option.set(scene, value);
    CHECK(scene == Scene{});
    if (option.kind == OptionKind::flag || option.kind == OptionKind::texts) continue;
    option.set(scene, parse_value(option, value_text(value)));
    CHECK(scene == Scene{});
  }
}

TEST_CASE("a file that says nothing, and one that says all defaults, are the default scene") {
  Json document{{"body", "a.qgraph"}};
  Scene expected;
  expected.body = "a.qgraph";
  CHECK(scene_from(JsonField(document, "")) == expected);
  CHECK(scene_from(JsonField(to_json(expected), "")) == expected);
  for (const SceneOption& option : scene_options()) {
    if (!in_file(option) || option.get(expected).index() == 0) continue;
    CAPTURE(option.name);
    CHECK(to_json(expected).contains(Json::json_pointer(std::string(option.member))));
  }
}

TEST_CASE("every name of a choice is read and written, and no other") {
  for (const SceneOption& option : scene_options()) {
    if (option.kind != OptionKind::choice) continue;
    CAPTURE(option.name);
    for (const Choice& choice : option.choices) {
      Scene scene;
      option.set(scene, std::string(choice.name));
      CHECK(value_text(option.get(scene)) == choice.name);
      CHECK(full_help(option).find(std::string(choice.name) + ": " + std::string(choice.help)) != std::string::npos);
    }
    Scene scene;
    CHECK_THROWS_WITH_AS(option.set(scene, std::string("nothing")), doctest::Contains("allowed are"), InputError);
  }
}

TEST_CASE("the ranges of the table are those that a file may use") {
  for (const SceneOption& option : scene_options()) {
    if (!in_file(option) || option.range == Range{}) continue;
    CAPTURE(option.name);
    const Range& range = option.range;
    const bool whole = option.kind == OptionKind::whole;
    const auto step = [&](double at) { return whole ? 1 : 1e-4 * std::max(1.0, std::abs(at)); };
    if (range.has_low()) {
      CHECK(accepted(option, range.low) != range.above);
      CHECK_FALSE(accepted(option, range.low - step(range.low)));
      CHECK(accepted(option, range.low + step(range.low)));
    }
    if (range.has_high()) {
      CHECK(accepted(option, range.high) != range.below);
      CHECK_FALSE(accepted(option, range.high + step(range.high)));
      CHECK(accepted(option, range.high - step(range.high)));
    }
  }
}

TEST_CASE("texts of a command line are understood or refused with what is allowed") {
  CHECK(std::get<double>(parse_value(option_named("error"), "1%")) == 0.01);
  CHECK(std::get<std::uint32_t>(parse_value(option_named("cycles"), "7")) == 7);
  for (const auto& [name, text, said] :
       {std::tuple{"error", "100%", "error: found '100%', expected a share (at least"},
        std::tuple{"cycles", "1.5", "cycles: found '1.5', expected a whole number"},
        std::tuple{"path-cells", "7", "(8 to 150)"}, std::tuple{"fov", "wide", "fov: found 'wide'"}}) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(parse_value(option_named(name), text), doctest::Contains(said), InputError);
  }
  Scene scene;
  option_named("size").set(scene, std::string("12X34"));
  CHECK(value_text(option_named("size").get(scene)) == "12x34");
  CHECK_THROWS_WITH_AS(option_named("size").set(scene, std::string("12")), doctest::Contains("WIDTHxHEIGHT"),
                       InputError);
}
