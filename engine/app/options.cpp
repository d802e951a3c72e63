#include "engine/app/options.h"

#include <CLI/CLI.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/outputs.h"
#include "engine/file/front.h"
#include "engine/scene/options.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/usual_light.h"

namespace quadgraph {
namespace {

// Of a body without a scene: what its picture converges to while nothing changes.
constexpr double converge_in_window = 0.01;

// What the user typed, before it is understood.
struct Typed {
  std::string file, output, preview, device;
  std::map<std::string_view, std::vector<std::string>> texts;  // of the scene's options, by name
  std::map<std::string_view, bool> flags;
  bool headless = false, copy_body = false, validation = false, json = false, strict = false;
};

void declare_flag(CLI::App& app, const SceneOption& option, Typed& typed) {
  const std::string name(option.name);
  app.add_flag("--" + name + ",!--no-" + name, typed.flags[option.name], full_help(option))
      ->default_str(value_text(option.get(Scene{})))
      ->group(std::string(option.group));
}

void declare_option(CLI::App& app, const SceneOption& option, Typed& typed) {
  auto* declared =
      app.add_option("--" + std::string(option.name), typed.texts[option.name], full_help(option))
          ->default_str(value_text(option.get(Scene{})))
          ->group(std::string(option.group))
          ->type_name(option.choices.empty() ? std::string(option.metavar) : "{" + value_allowed(option) + "}");
  if (option.kind == OptionKind::texts) {
    declared->allow_extra_args(false);
  } else {
    declared->expected(1);
  }
}

void declare(CLI::App& app, Typed& typed) {
  app.add_option("file", typed.file,
                 "a baked object, FILE.qgraph, or a scene, FILE.json, of which options replace what they name")
      ->required();
  app.add_flag("--headless", typed.headless,
               "write a picture and open no window; without a display there is no other way");
  app.add_option(
         "-o,--output", typed.output,
         "with --headless the picture to write: .png (sRGB) or .exr (linear, layers); in a window the beginning "
         "of the names of those that F12 writes, and of films (F9) and scenes (default: that of the file)")
      ->group(std::string(picture_group));
  for (const SceneOption& option : scene_options()) {
    if (!option.on_command_line) continue;
    option.kind == OptionKind::flag ? declare_flag(app, option, typed) : declare_option(app, option, typed);
  }
  app.add_option(
         "--preview", typed.preview,
         "in a window: the object is a preview, shown by shortest paths. NEWS is a JSON file, replaced while the "
         "window is open: {\"progress\": TEXT}, then {\"body\": FILE.qgraph}, to which it changes over, or "
         "{\"failed\": TEXT}")
      ->type_name("NEWS")
      ->group("Run");
  app.add_flag("--copy-body", typed.copy_body,
               "in a window: the object will not stay where it is; scenes that are saved get a copy of it beside them")
      ->group("Run");
  app.add_option("--device", typed.device, "cpu, or part of a Vulkan device's name; default: a GPU, else cpu")
      ->group("Run");
  app.add_flag("--validation", typed.validation,
               "load the validation layer of a Vulkan device; any message is an error")
      ->group("Run");
  app.add_flag("--json", typed.json, "print the report as JSON")->group("Run");
  app.add_flag("--strict", typed.strict, "with --headless: exit code 3 where --error is missed (default: a warning)")
      ->group("Run");
}

void check_output(const AppOptions& options) {
  const auto extension = options.output.extension();
  if (extension != ".png" && extension != ".exr") {
    throw InputError("output: found '" + options.output.string() + "', expected a name ending in .png or .exr (-o)");
  }
}

bool given(const CLI::App& app, std::string_view name) {
  return app.count("--" + std::string(name)) > 0;
}

// Puts the options that were given into the scene.
void apply(const Typed& typed, const CLI::App& app, Scene& scene) {
  for (const SceneOption& option : scene_options()) {
    if (!option.on_command_line || !given(app, option.name)) continue;
    if (option.kind == OptionKind::flag) {
      option.set(scene, typed.flags.at(option.name));
    } else if (option.kind == OptionKind::texts) {
      option.set(scene, typed.texts.at(option.name));
    } else {
      option.set(scene, parse_value(option, typed.texts.at(option.name).back()));
    }
  }
}

// The scene that is typed; `opened` becomes the file that it is of, where that has frames of its own.
Scene scene_of(const Typed& typed, const CLI::App& app, std::optional<SceneFile>& opened) {
  const std::filesystem::path file = typed.file;
  const bool from_file = file.extension() == ".json";
  Scene scene;
  if (from_file) {
    opened = SceneFile::load(file);
    scene = opened->at(0);
    if (opened->frames() < 2) opened.reset();
  } else {
    scene.body = file;
    scene.render.ground = !typed.headless;
    if (!typed.headless) scene.render.converge = converge_in_window;
  }
  apply(typed, app, scene);
  if (!from_file && !given(app, "view")) scene.view.azimuth = first_view(front_of(file), scene.view.up).azimuth;
  const bool lit = given(app, "light");
  if (lit) scene.lights = named_lights(typed.texts.at("light"), scene.view);
  const bool on_ground = !typed.headless || given(app, "ground");
  if (!from_file) light_unlit(scene, scene.view, {.lights = lit, .ground = on_ground});
  return scene;
}

// All texts of a scene, some of which name the files that it reads.
std::vector<std::string> texts_of(const Scene& scene) {
  std::vector<std::string> texts;
  const Json document = to_json(scene);
  std::vector<const Json*> waiting = {&document};
  while (!waiting.empty()) {
    const Json& value = *waiting.back();
    waiting.pop_back();
    if (value.is_string()) texts.push_back(value.get<std::string>());
    if (value.is_structured()) {
      for (const Json& item : value) waiting.push_back(&item);
    }
  }
  return texts;
}

AppOptions understood(const Typed& typed, const CLI::App& app) {
  AppOptions options;
  options.headless = typed.headless;
  options.output = typed.output;
  if (options.headless) check_output(options);
  options.scene = scene_of(typed, app, options.file);
  if (options.headless) {
    std::vector<std::string> inputs = texts_of(options.scene);
    inputs.push_back(typed.file);
    check_not_read(options.output, inputs);
  }
  if (!typed.preview.empty() && options.headless) {
    throw InputError("--preview: found with --headless; pictures are made of what is there");
  }
  if (typed.copy_body && options.headless) throw InputError("--copy-body: found with --headless, which saves no scene");
  options.preview = typed.preview;
  options.copy_body = typed.copy_body;
  options.device.validation = typed.validation;
  options.device.device = typed.device;
  options.json = typed.json;
  options.strict = typed.strict;
  return options;
}

}  // namespace

std::optional<AppOptions> parse_command_line(int argc, const char* const* argv, int& exit_code) {
  CLI::App app(
      "Shows a translucent object in a window: light enters, diffuses through the body and leaves it. F1 lists the "
      "keys.",
      "quadgraph-engine");
  app.set_version_flag("--version", QUADGRAPH_VERSION);
  app.footer(
      "Examples: quadgraph-engine bunny.qgraph\n"
      "          quadgraph-engine bunny.qgraph --headless -o bunny.png --material skin1 --view 20,15");
  Typed typed;
  declare(app, typed);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    exit_code = app.exit(success);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw InputError(std::string(error.what()) + " (--help lists the options)");
  }
  return understood(typed, app);
}

}  // namespace quadgraph
