#include "engine/scene/scene.h"

#include "engine/base/text.h"
#include "engine/optics/material.h"
#include "engine/scene/cut_json.h"
#include "engine/scene/deformer_json.h"
#include "engine/scene/edit_json.h"
#include "engine/scene/light_json.h"
#include "engine/scene/placement_json.h"
#include "engine/scene/volume.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t many = 1000000;  // iterations, bounces

// As a text of numbers joined by '/'.
std::string numbers(const JsonField& field) {
  if (field.value().is_string()) return field.text();
  if (!field.value().is_array()) return number_text(field.number());
  std::string text;
  for (const JsonField& item : field.items()) text += (text.empty() ? "" : "/") + number_text(item.number());
  return text;
}

// A text as parse_material reads it, or an object of the same fields with "name".
std::string material_from(const JsonField& field) {
  std::string text;
  if (field.value().is_object()) {
    if (const auto name = field.find("name")) text = name->text();
    for (const auto& [key, value] : field.value().items()) {
      if (key != "name") text += (text.empty() ? "" : ",") + key + "=" + numbers(field.at(key));
    }
  } else {
    text = field.text();
  }
  field.within([&] { check_material_text(text); });
  return text;
}

View view_from(const JsonField& field) {
  field.allow({"azimuth", "elevation", "distance", "up", "fov", "target"});
  View view;
  if (const auto azimuth = field.find("azimuth")) view.azimuth = azimuth->real();
  if (const auto elevation = field.find("elevation")) view.elevation = elevation->real();
  if (const auto distance = field.find("distance")) view.distance = distance->real();
  if (const auto fov = field.find("fov")) view.vertical_fov = fov->real();
  if (const auto target = field.find("target")) view.target = target->triple();
  if (const auto up = field.find("up")) {
    if (up->text() != "y" && up->text() != "z") up->refuse("\"y\" or \"z\"");
    view.up = up->text() == "z" ? UpAxis::z : UpAxis::y;
  }
  field.within([&] { check_view(view); });
  return view;
}

Json view_json(const View& view) {
  Json json{{"azimuth", real_json(view.azimuth)}, {"elevation", real_json(view.elevation)}};
  if (view.distance) json["distance"] = real_json(*view.distance);
  json["up"] = view.up == UpAxis::z ? "z" : "y";
  json["fov"] = real_json(view.vertical_fov);
  if (view.target != glm::vec3(0)) json["target"] = triple_json(view.target);
  return json;
}

PathOptions path_from(const JsonField& field) {
  field.allow({"cost", "solver", "cells"});
  PathOptions path;
  if (const auto cost = field.find("cost")) {
    path.cost = cost->within([&] { return path_cost_from_name(cost->text()); });
  }
  if (const auto solver = field.find("solver")) {
    path.solver = solver->within([&] { return path_solver_from_name(solver->text()); });
  }
  if (const auto cells = field.find("cells")) path.cells = cells->whole(least_path_cells, most_path_cells);
  return path;
}

SolveOptions solve_from(const JsonField& field) {
  field.allow({"method", "solver", "source", "model", "tolerance", "error", "cycles", "max_iterations",
               "inter_reflection", "bounces", "active_layers", "path"});
  SolveOptions options;
  const auto named = [&](std::string_view key, auto& value, const auto& parse) {
    if (const auto name = field.find(key)) value = name->within([&] { return parse(name->text()); });
  };
  named("method", options.method, method_from_name);
  named("solver", options.solver, solver_from_name);
  named("source", options.source, source_from_name);
  named("model", options.model, model_from_name);
  if (const auto tolerance = field.find("tolerance")) options.tolerance = tolerance->number();
  if (const auto error = field.find("error")) options.error = error->number();
  if (const auto cycles = field.find("cycles")) options.cycles = cycles->whole(0, many);
  if (const auto most = field.find("max_iterations")) options.max_iterations = most->whole(1, many);
  if (const auto light = field.find("inter_reflection")) options.inter_reflection = light->truth();
  if (const auto bounces = field.find("bounces")) options.bounces = bounces->whole(0, many);
  if (const auto layers = field.find("active_layers")) options.active_layers = layers->whole(0, many);
  if (const auto path = field.find("path")) options.path = path_from(*path);
  field.within([&] { check_options(options); });
  return options;
}

Json path_json(const PathOptions& path) {
  return {{"cost", name_of(path.cost)}, {"solver", name_of(path.solver)}, {"cells", path.cells}};
}

Json solve_json(const SolveOptions& options) {
  return {{"method", name_of(options.method)},
          {"solver", name_of(options.solver)},
          {"source", name_of(options.source)},
          {"model", name_of(options.model)},
          {"tolerance", options.tolerance},
          {"error", options.error},
          {"cycles", options.cycles},
          {"max_iterations", options.max_iterations},
          {"inter_reflection", options.inter_reflection},
          {"bounces", options.bounces},
          {"active_layers", options.active_layers},
          {"path", path_json(options.path)}};
}

void background_from(const JsonField& field, ToneOptions& tone) {
  if (field.value().is_object()) {
    field.allow({"top", "bottom"});
    ToneOptions end;
    background_from(field.at("top"), end);
    tone.background_top = end.background_top;
    background_from(field.at("bottom"), end);
    tone.background_bottom = end.background_bottom;
    return;
  }
  const std::string text = numbers(field);
  field.within([&] { parse_background(text, tone); });
}

void picture_from(const JsonField& field, RenderOptions& render, ToneOptions& tone) {
  field.allow({"width", "height", "roughness", "radiance", "exposure", "background", "show", "ground", "surroundings",
               "roughness_map"});
  if (const auto width = field.find("width")) render.width = width->whole(1, largest_side);
  if (const auto height = field.find("height")) render.height = height->whole(1, largest_side);
  if (const auto roughness = field.find("roughness")) render.roughness = roughness->real();
  if (const auto radiance = field.find("radiance")) {
    render.radiance = radiance->within([&] { return radiance_from_name(radiance->text()); });
  }
  if (const auto ground = field.find("ground")) render.ground = ground->truth();
  if (const auto around = field.find("surroundings")) render.surroundings = around->truth();
  if (const auto map = field.find("roughness_map")) {
    map->allow({"image", "placement", "roughness"});
    render.roughness_map = {image_from(map->at("image")), placement_from(map->at("placement"))};
    if (const auto roughness = map->find("roughness")) render.roughness_map->roughness = roughness->real();
  }
  if (const auto show = field.find("show")) {
    render.show = show->within([&] { return parse_show(show->text()); });
  }
  if (const auto exposure = field.find("exposure")) {
    const std::string text = numbers(*exposure);
    tone.exposure_stops = exposure->within([&] { return parse_exposure(text); });
  }
  if (const auto background = field.find("background")) background_from(*background, tone);
  field.within([&] { check_options(render); });
}

Json picture_json(const RenderOptions& render, const ToneOptions& tone) {
  Json json{{"width", render.width},
            {"height", render.height},
            {"roughness", real_json(render.roughness)},
            {"radiance", name_of(render.radiance)},
            {"show", to_string(render.show)},
            {"ground", render.ground},
            {"surroundings", render.surroundings}};
  if (const auto& map = render.roughness_map) {
    json["roughness_map"] = {{"image", to_json(*map->image)},
                             {"placement", to_json(map->placement)},
                             {"roughness", real_json(map->roughness)}};
  }
  json["exposure"] = tone.exposure_stops ? real_json(*tone.exposure_stops) : Json("auto");
  json["background"] = {{"top", rgb_json(tone.background_top)}, {"bottom", rgb_json(tone.background_bottom)}};
  return json;
}

}  // namespace

Scene scene_from(const JsonField& document) {
  Scene scene;
  scene.body = document.at("body").text();
  if (const auto material = document.find("material")) scene.material = material_from(*material);
  if (const auto edits = document.find("edits")) {
    for (const JsonField& edit : edits->items()) scene.edits.push_back(edit_from(edit));
  }
  if (const auto lights = document.find("lights")) {
    for (const JsonField& light : lights->items()) scene.lights.push_back(light_from(light));
  }
  if (const auto deformation = document.find("deformation")) {
    for (const JsonField& deformer : deformation->items()) scene.deformation.push_back(deformer_from(deformer));
  }
  if (const auto cuts = document.find("cuts")) {
    for (const JsonField& cut : cuts->items()) scene.cuts.push_back(cut_from(cut));
  }
  if (const auto camera = document.find("camera")) scene.view = view_from(*camera);
  if (const auto solver = document.find("solver")) scene.solve = solve_from(*solver);
  if (const auto picture = document.find("picture")) picture_from(*picture, scene.render, scene.tone);
  return scene;
}

Json to_json(const Scene& scene) {
  Json edits = Json::array(), lights = Json::array(), deformation = Json::array(), cuts = Json::array();
  for (const Edit& edit : scene.edits) edits.push_back(to_json(edit));
  for (const Deformer& deformer : scene.deformation) deformation.push_back(to_json(deformer));
  for (const BodyCut& cut : scene.cuts) cuts.push_back(to_json(cut));
  for (const Light& light : scene.lights) lights.push_back(to_json(light));
  return {{"quadgraph_scene", 1},
          {"body", scene.body.string()},
          {"material", scene.material},
          {"edits", std::move(edits)},
          {"lights", std::move(lights)},
          {"deformation", std::move(deformation)},
          {"cuts", std::move(cuts)},
          {"camera", view_json(scene.view)},
          {"solver", solve_json(scene.solve)},
          {"picture", picture_json(scene.render, scene.tone)}};
}

}  // namespace quadgraph
