// The command line of quadgraph-engine against the table of scene options.
#include "engine/app/options.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/render/light/default_lights.h"
#include "engine/scene/options.h"
#include "tests/cpp/fixtures/test_data.h"

using namespace quadgraph;

namespace {

const std::string cube = test_data("tiny.qgraph").string();

Scene parsed(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"quadgraph-engine", cube, "--headless", "-o", "a.png"});
  std::vector<const char*> argv;
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  int code = 0;
  const auto options = parse_command_line(static_cast<int>(argv.size()), argv.data(), code);
  REQUIRE(options);
  return options->scene;
}

}  // namespace

TEST_CASE("without options the command line shows the default scene") {
  Scene expected;
  expected.body = cube;
  expected.lights = {studio_of(expected.view)};
  expected.render.ground = true;
  CHECK(parsed({}) == expected);
}

TEST_CASE("lights by name stand about the view, and what is lit has no ground of itself") {
  const Scene lamps = parsed({"--light", "lamps", "--view", "40,10", "--light", "studio"});
  std::vector<Light> expected = default_lights(lamps.view);
  expected.push_back(studio_of(lamps.view));
  CHECK(lamps.lights == expected);
  CHECK(!lamps.render.ground);
  CHECK(parsed({"--light", "lamps", "--ground"}).render.ground);
  CHECK(!parsed({"--no-ground"}).render.ground);
  CHECK(parsed({"--no-ground"}).lights == std::vector{studio_of(View{})});
}

TEST_CASE("every option of the table is one of the command line and does what its text says") {
  for (const SceneOption& option : scene_options()) {
    // A normal map must be a file: tests/python/engine/test_normal_maps.py gives the program one.
    if (!option.on_command_line || option.name == "normal-map") continue;
    CAPTURE(option.name);
    const std::string name = "--" + std::string(option.name);
    if (option.kind == OptionKind::flag) {
      for (const bool on : {true, false}) {
        const Scene scene = parsed({on ? name : "--no-" + std::string(option.name)});
        CHECK(std::get<bool>(option.get(scene)) == on);
      }
    } else if (option.kind == OptionKind::texts) {
      const bool of_bodies = option.name == "material-of";
      const std::string first = of_bodies ? "cup=jade" : "ambient:1", second = of_bodies ? "lid=wax" : "ambient:2";
      CHECK(value_text(option.get(parsed({name, first, name, second}))) == first + " " + second);
    } else {
      const std::string usual = value_text(option.get(Scene{}));
      std::string text = option.choices.empty() ? usual : std::string(option.choices.back().name);
      if (option.name == "map") text = "box,scale=2";
      if (option.name == "view") text = "10,20";
      if (text.empty())
        text = option.kind != OptionKind::number ? "1,2,30" : option.range.contains(12.0) ? "12" : "0.5";
      std::vector<std::string> given = {name, text};
      if (option.name == "eye") given.insert(given.end(), {"--look-at", "0,0,0"});
      if (option.name == "map") given.insert(given.end(), {"--material", "wax.npz"});
      if (option.name == "look-at") given.insert(given.end(), {"--eye", "0,0,0"});
      CHECK(value_text(option.get(parsed(given))) == text);
    }
  }
}

TEST_CASE("a window has a ground without being asked, a picture of what is lit has not") {
  int code = 0;
  const char* argv[] = {"quadgraph-engine", cube.c_str()};
  CHECK(parse_command_line(2, argv, code)->scene.render.ground);
  const char* lit[] = {"quadgraph-engine", cube.c_str(), "--light", "studio"};
  CHECK(parse_command_line(4, lit, code)->scene.render.ground);
  CHECK_FALSE(parsed({"--light", "studio"}).render.ground);
}

TEST_CASE("a scene that is saved gets a copy of its body where a window is told to make one") {
  CHECK_THROWS_AS(parsed({"--copy-body"}), InputError);
  int code = 0;
  const char* argv[] = {"quadgraph-engine", cube.c_str(), "--copy-body"};
  CHECK(parse_command_line(3, argv, code)->copy_body);
  CHECK_FALSE(parse_command_line(2, argv, code)->copy_body);
}

TEST_CASE("a preview is for a window") {
  CHECK_THROWS_AS(parsed({"--preview", "news.json"}), InputError);
  int code = 0;
  const char* argv[] = {"quadgraph-engine", cube.c_str(), "--preview", "news.json"};
  CHECK(parse_command_line(4, argv, code)->preview == "news.json");
}
