#include "engine/scene/options.h"

#include "engine/base/text.h"
#include "engine/optics/material.h"
#include "engine/scene/camera_options.h"
#include "engine/scene/option_forms.h"
#include "engine/scene/option_members.h"

namespace quadgraph {
namespace {

constexpr Range up_to_a_million{.low = 0, .high = 1000000};

void add_scene(OptionTable& table) {
  table.group(scene_group);
  table.text(
      OptionKind::text,
      {.name = "material", .member = "/material", .own_form = true, .metavar = "M", .help = material_help()},
      [](const Scene& scene) { return scene.material; },
      [](Scene& scene, const OptionValue& value) { scene.material = text_in(value); });
  table.text(
      OptionKind::texts,
      {.name = "material-of", .member = "/materials", .own_form = true, .metavar = "BODY=M", .help = body_help()},
      materials_of, set_materials_of);
  table.text(OptionKind::text, {.name = "map", .own_form = true, .metavar = "KIND[,NAME=VALUE]", .help = map_help()},
             map_of, set_map);
  table.text(OptionKind::texts,
             {.name = "light", .member = "/lights", .own_form = true, .metavar = "L", .help = light_help()}, lights_of,
             set_lights);
}

void add_solver(OptionTable& table) {
  table.group(solver_group);
  table.member<&Scene::solve, &SolveOptions::method>(
      {.name = "method", .member = "/solver/method", .keyword = "method", .help = "how light in the body is computed"});
  table.member<&Scene::solve, &SolveOptions::solver>(
      {.name = "solver", .member = "/solver/solver", .keyword = "solver", .help = "solver of the linear system"});
  table.member<&Scene::solve, &SolveOptions::source>(
      {.name = "source", .member = "/solver/source", .keyword = "source", .help = "how light enters the body"});
  table.member<&Scene::solve, &SolveOptions::model>(
      {.name = "model", .member = "/solver/model", .keyword = "model", .help = "model of light transport"});
}

void add_accuracy(OptionTable& table) {
  table
      .member<&Scene::solve, &SolveOptions::tolerance>(
          {.name = "tolerance",
           .member = "/solver/tolerance",
           .keyword = "tolerance",
           .metavar = "T",
           .range = tolerance_range,
           .help = "stop when the exitance is estimated to be solved to this relative RMS error, over the whole "
                   "surface and over its unlit part"})
      .kind = OptionKind::share;
  table
      .member<&Scene::solve, &SolveOptions::error>(
          {.name = "error",
           .member = "/solver/error",
           .keyword = "error",
           .metavar = "E",
           .range = error_range,
           .help = "stop when solver and mesh error together are estimated to be below E, e.g. 1%, on the coarsest "
                   "level of the file that allows it; a warning if none does; 0: no target, the finest level"})
      .kind = OptionKind::share;
  table.member<&Scene::solve, &SolveOptions::cycles>(
      {.name = "cycles",
       .member = "/solver/cycles",
       .keyword = "cycles",
       .range = up_to_a_million,
       .help = "exactly N iterations on the finest level; 0: as many as the tolerance takes"});
  table.member<&Scene::solve, &SolveOptions::max_iterations>({.name = "max-iterations",
                                                              .member = "/solver/max_iterations",
                                                              .keyword = "max_iterations",
                                                              .range = {.low = 1, .high = up_to_a_million.high},
                                                              .help = "most iterations per level"});
}

void add_light_paths(OptionTable& table) {
  table.member<&Scene::solve, &SolveOptions::inter_reflection>(
      {.name = "inter-reflection",
       .member = "/solver/inter_reflection",
       .keyword = "inter_reflection",
       .help = "light that leaves one part of the object and enters another"});
  table.member<&Scene::solve, &SolveOptions::bounces>(
      {.name = "bounces",
       .member = "/solver/bounces",
       .keyword = "bounces",
       .range = up_to_a_million,
       .help = "bounces of inter-reflection; 0: until they change nothing"});
  table.member<&Scene::solve, &SolveOptions::correction>(
      {.name = "correction",
       .member = "/solver/correction",
       .keyword = "correction",
       .help = "correct the solution by sweeps of the transport equation (method fem, source buried)"});
  table.member<&Scene::solve, &SolveOptions::sweeps>(
      {.name = "sweeps",
       .member = "/solver/sweeps",
       .keyword = "sweeps",
       .range = sweeps_range,
       .help = "sweeps of the transport equation; 0: until another one would change little"});
  table.member<&Scene::solve, &SolveOptions::sweep_points>(
      {.name = "sweep-points",
       .member = "/solver/sweep_points",
       .keyword = "sweep_points",
       .range = sweep_points_range,
       .help = "points inside the body at which a sweep evaluates the transport equation"});
  table.member<&Scene::solve, &SolveOptions::sweep_seed>(
      {.name = "sweep-seed",
       .member = "/solver/sweep_seed",
       .keyword = "sweep_seed",
       .range = up_to_a_million,
       .help = "what the points and rays of sweeps are drawn by: what two seeds differ by is noise"});
  table.member<&Scene::solve, &SolveOptions::certify>(
      {.name = "certify",
       .member = "/solver/certify",
       .keyword = "certify",
       .range = certify_range,
       .help =
           "seconds in which random walks through the tets, which share nothing with the solver, measure how far the "
           "exitance is off; 0: none"});
  table.member<&Scene::solve, &SolveOptions::guided_walks>(
      {.name = "guided-walks",
       .member = "/solver/guided_walks",
       .keyword = "guided_walks",
       .help = "random walks of --certify are led to where little light leaves, which tells more of some bodies and "
               "less of others"});
  table.member<&Scene::solve, &SolveOptions::active_layers>(
      {.name = "active-layers",
       .member = "/solver/active_layers",
       .keyword = "active_layers",
       .range = up_to_a_million,
       .help = "layers of a polygrid that are solved for on all levels but the coarsest, the rest being taken from "
               "the coarser level, as published; 0: all"});
}

void add_path(OptionTable& table) {
  table.group(path_group);
  table.member<&Scene::solve, &SolveOptions::path, &PathOptions::cost>(
      {.name = "path-cost", .member = "/solver/path/cost", .keyword = "path_cost", .help = "cost of a mm of path"});
  table.member<&Scene::solve, &SolveOptions::path, &PathOptions::solver>({.name = "path-solver",
                                                                          .member = "/solver/path/solver",
                                                                          .keyword = "path_solver",
                                                                          .help = "how the cheapest paths are found"});
  table.member<&Scene::solve, &SolveOptions::path, &PathOptions::cells>(
      {.name = "path-cells",
       .member = "/solver/path/cells",
       .keyword = "path_cells",
       .range = path_cells_range,
       .help = "voxels along the longest side, " + path_cells_range.text()});
}

// Options for bodies in motion: programs and the window have them, command lines and files do not.
void add_motion(OptionTable& table) {
  table.group(solver_group);
  table.member<&Scene::solve, &SolveOptions::warm>(
      {.name = "warm",
       .keyword = "warm",
       .on_command_line = false,
       .help = "start from the last solution of the same method and model"});
  table.member<&Scene::solve, &SolveOptions::carry>(
      {.name = "carry",
       .keyword = "carry",
       .on_command_line = false,
       .help = "without correction, what the last one made of the exitance is carried on as a factor"});
  table.member<&Scene::solve, &SolveOptions::smoothing>(
      {.name = "smoothing",
       .keyword = "smoothing",
       .on_command_line = false,
       .range = {.low = 0, .high = 2},
       .help = "smoothing steps of a cycle before and after its coarse-grid correction; 0: the cheapest number"});
  table.member<&Scene::solve, &SolveOptions::exchange_rows>(
      {.name = "exchange-rows",
       .keyword = "exchange_rows",
       .on_command_line = false,
       .range = {.low = 0},
       .help = "faces of a deforming body whose visibility is traced again in each solve; 0: all of them"});
  table.member<&Scene::solve, &SolveOptions::mean_rays>({.name = "mean-rays",
                                                         .keyword = "mean_rays",
                                                         .on_command_line = false,
                                                         .help = "isotropic light by one ray from an origin instead of "
                                                                 "eight, rays that end with 1% of their light, and "
                                                                 "fewer samples of shadows"});
}

void add_size(OptionTable& table) {
  table.group(picture_group);
  table.text(OptionKind::text,
             {.name = "size",
              .member = "/picture/width",
              .keyword = "size",
              .own_form = true,
              .metavar = "WxH",
              .help = "width and height in pixels; a window has its own"},
             size_of, set_size);
  table.member<&Scene::render, &RenderOptions::width>({.name = "width",
                                                       .member = "/picture/width",
                                                       .keyword = "width",
                                                       .on_command_line = false,
                                                       .range = side_range,
                                                       .help = "pixels"});
  table.member<&Scene::render, &RenderOptions::height>({.name = "height",
                                                        .member = "/picture/height",
                                                        .keyword = "height",
                                                        .on_command_line = false,
                                                        .range = side_range,
                                                        .help = "pixels"});
  table.member<&Scene::render, &RenderOptions::samples>(
      {.name = "samples",
       .member = "/picture/samples",
       .keyword = "samples",
       .range = samples_range,
       .help = "samples of a pixel, of which it is the mean, four at a time; 0: 16, and 256 with an aperture"});
  table.member<&Scene::render, &RenderOptions::filter>(
      {.name = "filter",
       .member = "/picture/filter",
       .keyword = "filter",
       .help = "how samples around the middle of a pixel are weighed; more than four are wanted"});
}

void add_convergence(OptionTable& table) {
  table
      .member<&Scene::render, &RenderOptions::converge>(
          {.name = "converge",
           .member = "/picture/converge",
           .keyword = "converge",
           .metavar = "E",
           .range = converge_range,
           .help = "corrections and samples run on, and the picture is the mean of all, until its stated error, model "
                   "and noise included, is at most E, e.g. 1%, or until they win nothing more; in a window while "
                   "nothing changes; 0: no target"})
      .kind = OptionKind::share;
  table.member<&Scene::render, &RenderOptions::time_limit>({.name = "time-limit",
                                                            .member = "/picture/time_limit",
                                                            .keyword = "time_limit",
                                                            .metavar = "SECONDS",
                                                            .range = time_limit_range,
                                                            .help = "seconds for --converge; 0: as long as it takes"});
}

void add_picture(OptionTable& table) {
  table.member<&Scene::render, &RenderOptions::roughness>(
      {.name = "roughness",
       .member = "/picture/roughness",
       .keyword = "roughness",
       .metavar = "ALPHA",
       .range = roughness_range,
       .help = "roughness of the surface, GGX alpha, " + roughness_range.text() + "; default: that of the material, " +
               number_text(default_roughness) + " where it says none"});
  table.member<&Scene::render, &RenderOptions::transmission_roughness>(
      {.name = "transmission-roughness",
       .member = "/picture/transmission_roughness",
       .keyword = "transmission_roughness",
       .metavar = "ALPHA",
       .range = transmission_range,
       .help = "roughness of the surface for light that goes in and comes out, GGX alpha, " +
               transmission_range.text() + "; 0: smooth; default: the roughness"});
  table.text(
      OptionKind::text,
      {.name = "normal-map",
       .member = "/picture/normal_map",
       .keyword = "normal_map",
       .own_form = true,
       .metavar = "IMAGE",
       .help = "a normal map in tangent space (.png, green to the top), laid over all of the body from its front: "
               "what is mirrored, what enters and what is seen inside go by it. A scene file places it "
               "(docs/scene.md)"},
      normal_map_of, set_normal_map);
  table.member<&Scene::render, &RenderOptions::radiance>({.name = "radiance",
                                                          .member = "/picture/radiance",
                                                          .keyword = "radiance",
                                                          .help = "how light leaves the surface"});
  table.text(
      OptionKind::text,
      {.name = "show",
       .member = "/picture/show",
       .keyword = "show",
       .metavar = "WHAT",
       .help = std::string("the picture, or false colours of what is inside: ") + show_forms},
      [](const Scene& scene) { return to_string(scene.render.show); },
      [](Scene& scene, const OptionValue& value) { scene.render.show = parse_show(text_in(value)); });
  table.member<&Scene::render, &RenderOptions::ground>(
      {.name = "ground",
       .member = "/picture/ground",
       .keyword = "ground",
       .help = "what the object stands on: its shadow there, and the light that it gives. On by default in a window, "
               "and wherever no light is named"});
  table.member<&Scene::render, &RenderOptions::surroundings>({.name = "surroundings",
                                                              .member = "/picture/surroundings",
                                                              .keyword = "surroundings",
                                                              .help = "show environment lights behind the object"});
}

void add_tone(OptionTable& table) {
  table.member<&Scene::tone, &ToneOptions::curve>(
      {.name = "tone", .member = "/picture/tone", .help = "how radiance becomes what a screen shows"});
  table.member<&Scene::tone, &ToneOptions::white_balance>(
      {.name = "white-balance",
       .member = "/picture/white_balance",
       .metavar = "K",
       .range = kelvin_range,
       .help = "colour temperature of the light that is shown white, kelvin; 6504: none is changed"});
  table.text(OptionKind::number_or_text,
             {.name = "exposure",
              .member = "/picture/exposure",
              .metavar = "STOPS",
              .help = "auto, or stops: radiance times 2^stops"},
             stops_of, set_stops);
  table.text(OptionKind::text,
             {.name = "background",
              .member = "/picture/background",
              .own_form = true,
              .metavar = "COLOUR",
              .help = "studio, black, white, transparent (PNG only), linear grey or R/G/B in [0, 1]"},
             background_of, set_background);
}

std::vector<SceneOption> made() {
  OptionTable table;
  add_scene(table);
  add_camera_options(table);
  add_solver(table);
  add_accuracy(table);
  add_light_paths(table);
  add_path(table);
  add_motion(table);
  add_size(table);
  add_convergence(table);
  add_picture(table);
  add_tone(table);
  return table.take();
}

}  // namespace

std::span<const SceneOption> scene_options() {
  static const std::vector<SceneOption> all = made();
  return all;
}

}  // namespace quadgraph
