#include "engine/app/options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/file/front.h"
#include "engine/optics/material.h"
#include "engine/render/light/default_lights.h"
#include "engine/scene/scene_file.h"

namespace quadgraph {
namespace {

// What the user typed, before it is understood.
struct Typed {
  std::string file, output;
  std::string material = "marble";
  std::vector<std::string> lights;
  std::string view, up = "y";
  float fov = 30;
  std::string method = "fem", solver = "fmg-pcg", source = "buried", model = "auto";
  std::string tolerance = "0.001", error = "0";
  std::string path_cost = "transport", path_solver = "eikonal";
  std::uint32_t path_cells = 64;
  std::uint32_t cycles = 0;
  std::uint32_t max_iterations = 5000, bounces = 0, active_layers = 0;
  std::string size = "1024x1024", exposure = "auto", background = "studio";
  float roughness = 0.3f;
  std::string radiance = "auto", show = "picture";
  std::string device;
  bool ground = false, surroundings = false;
  bool no_inter_reflection = false, headless = false, validation = false, json = false;
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void declare_scene(CLI::App& app, Typed& typed) {
  app.add_option(
         "--material", typed.material,
         joined(material_names()) +
             "; or sigma_s_prime=2.0,sigma_a=0.01,eta=1.3 (1/mm; one value or R/G/B each); or "
             "reflectance=0.8/0.6/0.5,mean_free_path=0.5 (mm), the colour that a thick body shows; or NAME,key=value")
      ->capture_default_str()
      ->group("Scene");
  app.add_option("--light", typed.lights,
                 std::string(light_forms) + "; may be repeated. Default: one from behind, one from the side")
      ->allow_extra_args(false)
      ->group("Scene");
  app.add_option("--view", typed.view,
                 "azimuth,elevation[,distance] in degrees and mm from the object's centre; azimuth 0 looks along -z, "
                 "90 along -x; without a distance the object fits the picture. Default: elevation 10 from the front, "
                 "as the bake found or was told it")
      ->group("Scene");
  app.add_option("--up", typed.up, "y or z; with z, azimuth 0 looks along +y")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str()
      ->group("Scene");
  app.add_option("--fov", typed.fov, "vertical field of view, degrees")->capture_default_str()->group("Scene");
}

void declare_solver(CLI::App& app, Typed& typed) {
  app.add_option("--method", typed.method,
                 "fem, quadgraph-fv, quadgraph-fdm, polygrid, polygrid-divergence or shortest-path")
      ->capture_default_str()
      ->group("Solver");
  app.add_option("--solver", typed.solver, "fmg-pcg, vcycle, dpcg, cascade, jacobi or auto (fmg-pcg or dpcg)")
      ->capture_default_str()
      ->group("Solver");
  app.add_option("--source", typed.source,
                 "buried (light scatters inside) or diffuse (enters at the surface, as published)")
      ->capture_default_str()
      ->group("Solver");
  app.add_option("--model", typed.model,
                 "diffusion, sp3, or auto: diffusion where it is within 1% of sp3, and for the published baseline")
      ->capture_default_str()
      ->group("Solver");
  app.add_option("--tolerance", typed.tolerance,
                 "relative RMS error to which the exitance is solved, over the whole surface and over its unlit part")
      ->capture_default_str()
      ->group("Solver");
  app.add_option("--error", typed.error,
                 "the same with the error of the mesh, e.g. 1%, on a level as coarse as that allows; exit 3 if none "
                 "does; 0: no target, the finest level")
      ->capture_default_str()
      ->group("Solver");
  app.add_option("--cycles", typed.cycles, "iterations on the finest level; 0: as many as the tolerance takes")
      ->capture_default_str()
      ->group("Solver");
  app.add_option("--max-iterations", typed.max_iterations, "per level")->capture_default_str()->group("Solver");
  app.add_flag("--no-inter-reflection", typed.no_inter_reflection,
               "leave out light that leaves one part of the object and enters another")
      ->group("Solver");
  app.add_option("--active-layers", typed.active_layers,
                 "of a polygrid that are solved for on all levels but the coarsest; 0: all")
      ->group("Solver");
  app.add_option("--bounces", typed.bounces, "of that light; 0: until they change nothing")
      ->capture_default_str()
      ->group("Solver");
}

void declare_path(CLI::App& app, Typed& typed) {
  app.add_option("--path-cost", typed.path_cost,
                 "of a mm of path: transport (the effective transport coefficient), or extinction as published")
      ->capture_default_str()
      ->group("Method shortest-path");
  app.add_option("--path-solver", typed.path_solver,
                 "eikonal (any path), or lattice: steps between the 26 neighbours of a voxel, as published")
      ->capture_default_str()
      ->group("Method shortest-path");
  app.add_option("--path-cells", typed.path_cells, "voxels along the longest side, 8 to 150")
      ->capture_default_str()
      ->group("Method shortest-path");
}

void declare_picture(CLI::App& app, Typed& typed) {
  app.add_option(
         "-o,--output", typed.output,
         "with --headless the picture to write: .png (sRGB) or .exr (linear, layers); in a window the beginning "
         "of the names of those that F12 writes (default: that of the file)")
      ->group("Picture");
  app.add_option("--size", typed.size, "WIDTHxHEIGHT in pixels; of a window it has its own")
      ->capture_default_str()
      ->group("Picture");
  app.add_option("--radiance", typed.radiance,
                 "gathered (one more step of transport along every view ray), lambertian (the same from every side but "
                 "for Fresnel), single (that, and light scattered once along the view ray), or auto: gathered where it "
                 "can be (fem and polygrids, buried)")
      ->capture_default_str()
      ->group("Picture");
  app.add_option(
         "--show", typed.show,
         "picture, or in false colour what is inside: q, exitance, error, difference[:METHOD], levels[:N], "
         "phi[:AXIS[,MM]], tets[:AXIS[,MM[,N]]] or links[:AXIS[,MM[,N]]]; AXIS x, y or z across a cutting plane "
         "MM from the object's centre, N a level")
      ->capture_default_str()
      ->group("Picture");
  app.add_option("--exposure", typed.exposure, "auto, or stops: radiance times 2^stops")
      ->capture_default_str()
      ->group("Picture");
  app.add_option("--background", typed.background, "studio, black, white, linear grey or R/G/B in [0, 1] (PNG)")
      ->capture_default_str()
      ->group("Picture");
  app.add_flag("--ground,!--no-ground", typed.ground,
               "a shadow on the ground where the object stands; windows have it, other pictures with --ground")
      ->group("Picture");
  app.add_flag("--surroundings", typed.surroundings, "what environment lights show, behind the object")
      ->group("Picture");
  app.add_option("--roughness", typed.roughness, "of the surface, GGX alpha, 0.02 to 1")
      ->capture_default_str()
      ->group("Picture");
}

void declare(CLI::App& app, Typed& typed) {
  app.add_option("file", typed.file,
                 "a baked object, FILE.qgraph, or a scene, FILE.json, of which options replace what they name")
      ->required();
  app.add_flag("--headless", typed.headless,
               "write a picture and open no window; without a display there is no other way");
  declare_scene(app, typed);
  declare_solver(app, typed);
  declare_path(app, typed);
  declare_picture(app, typed);
  app.add_option("--device", typed.device, "part of the Vulkan device's name")->group("Run");
  app.add_flag("--validation", typed.validation, "load the Vulkan validation layer; any message is an error")
      ->group("Run");
  app.add_flag("--json", typed.json, "print the report as JSON")->group("Run");
}

std::uint32_t parse_side(std::string_view text, const std::string& whole) {
  const double side = parse_number(text, "size '" + whole + "'");
  if (side < 1 || side > 65535 || side != std::floor(side)) {
    throw InputError("size: found '" + whole + "', expected WIDTHxHEIGHT in whole pixels");
  }
  return static_cast<std::uint32_t>(side);
}

void parse_size(const std::string& text, RenderOptions& options) {
  const auto sides = split(text, 'x');
  if (sides.size() != 2) throw InputError("size: found '" + text + "', expected WIDTHxHEIGHT");
  options.width = parse_side(sides[0], text);
  options.height = parse_side(sides[1], text);
}

void check_output(const AppOptions& options) {
  const auto extension = options.output.extension();
  if (extension != ".png" && extension != ".exr") {
    throw InputError("output: found '" + options.output.string() + "', expected a name ending in .png or .exr (-o)");
  }
}

// A number, or percent.
double parse_share(std::string_view text, const std::string& what) {
  const bool percent = text.ends_with('%');
  if (percent) text.remove_suffix(1);
  return parse_number(text, what) / (percent ? 100 : 1);
}

// Tells which options replace what the scene says: all, unless it is from a file.
class Given {
 public:
  Given(const CLI::App& app, bool from_file) : app_(app), from_file_(from_file) {}

  bool operator()(const char* name) const { return !from_file_ || app_.count(name) > 0; }

 private:
  const CLI::App& app_;
  bool from_file_;
};

void take_view(const Typed& typed, const Given& given, View& view) {
  if (given("--up")) view.up = typed.up == "z" ? UpAxis::z : UpAxis::y;
  if (given("--fov")) view.vertical_fov = typed.fov;
  if (given("--view") && !typed.view.empty()) {
    view.distance.reset();
    view = parse_view(typed.view, view);
  }
}

void take_solve(const Typed& typed, const Given& given, SolveOptions& solve) {
  if (given("--method")) solve.method = method_from_name(typed.method);
  if (given("--solver")) solve.solver = solver_from_name(typed.solver);
  if (given("--source")) solve.source = source_from_name(typed.source);
  if (given("--model")) solve.model = model_from_name(typed.model);
  if (given("--tolerance")) solve.tolerance = parse_share(typed.tolerance, "tolerance");
  if (given("--error")) solve.error = parse_share(typed.error, "error");
  if (given("--path-cost")) solve.path.cost = path_cost_from_name(typed.path_cost);
  if (given("--path-solver")) solve.path.solver = path_solver_from_name(typed.path_solver);
  if (given("--path-cells")) solve.path.cells = typed.path_cells;
  if (given("--cycles")) solve.cycles = typed.cycles;
  if (given("--max-iterations")) solve.max_iterations = typed.max_iterations;
  if (given("--no-inter-reflection")) solve.inter_reflection = !typed.no_inter_reflection;
  if (given("--bounces")) solve.bounces = typed.bounces;
  if (given("--active-layers")) solve.active_layers = typed.active_layers;
}

void take_picture(const Typed& typed, const Given& given, Scene& scene) {
  if (given("--size")) parse_size(typed.size, scene.render);
  if (given("--ground")) scene.render.ground = typed.ground;
  if (given("--surroundings")) scene.render.surroundings = typed.surroundings;
  if (given("--roughness")) scene.render.roughness = typed.roughness;
  if (given("--radiance")) scene.render.radiance = radiance_from_name(typed.radiance);
  if (given("--show")) scene.render.show = parse_show(typed.show);
  if (given("--exposure")) scene.tone.exposure_stops = parse_exposure(typed.exposure);
  if (given("--background")) parse_background(typed.background, scene.tone);
}

Scene scene_of(const Typed& typed, const CLI::App& app) {
  const std::filesystem::path file = typed.file;
  const bool from_file = file.extension() == ".json";
  const Given given(app, from_file);
  Scene scene;
  if (from_file) scene = SceneFile::load(file).at(0);
  if (!from_file) scene.body = file;
  if (given("--material")) scene.material = typed.material;
  if (!from_file) scene.view = first_view(front_of(file), typed.up == "z" ? UpAxis::z : UpAxis::y);
  take_view(typed, given, scene.view);
  if (given("--light")) scene.lights.clear();
  for (const std::string& light : typed.lights) scene.lights.push_back(parse_light(light));
  if (scene.lights.empty()) scene.lights = default_lights(scene.view);
  take_solve(typed, given, scene.solve);
  take_picture(typed, given, scene);
  return scene;
}

AppOptions understood(const Typed& typed, const CLI::App& app) {
  AppOptions options;
  options.headless = typed.headless;
  options.output = typed.output;
  if (options.headless) check_output(options);
  options.scene = scene_of(typed, app);
  options.device.validation = typed.validation;
  options.device.device = typed.device;
  options.json = typed.json;
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
    if (app.count("--ground") == 0) typed.ground = !typed.headless;
  } catch (const CLI::Success& success) {
    exit_code = app.exit(success);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw InputError(std::string(error.what()) + " (--help lists the options)");
  }
  return understood(typed, app);
}

}  // namespace quadgraph
