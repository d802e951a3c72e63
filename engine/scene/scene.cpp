#include "engine/scene/scene.h"

#include <limits>
#include <type_traits>

#include "engine/base/text.h"
#include "engine/file/body_names.h"
#include "engine/optics/material.h"
#include "engine/render/light/normal_map_file.h"
#include "engine/scene/cut_json.h"
#include "engine/scene/deformer_json.h"
#include "engine/scene/edit_json.h"
#include "engine/scene/light_json.h"
#include "engine/scene/material_map.h"
#include "engine/scene/options.h"
#include "engine/scene/placement_json.h"
#include "engine/scene/volume.h"

namespace quadgraph {
namespace {

// A text, a number or an array as a text of numbers joined by '/'.
std::string numbers(const JsonField& field) {
  if (field.value().is_string()) return field.text();
  if (!field.value().is_array()) return number_text(field.number());
  std::string text;
  for (const JsonField& item : field.items()) text += (text.empty() ? "" : "/") + number_text(item.number());
  return text;
}

// The text of a volume, of an object with its file and how it is carried into the body.
std::string volume_from(const JsonField& field) {
  field.allow({"volume", "map", "scale", "repeat", "depth", "from"});
  std::string text = field.at("volume").text();
  if (field.value().size() > 1) text += ",map=" + field.at("map").text();
  for (const char* name : {"scale", "depth"}) {
    if (const auto number = field.find(name)) text += "," + std::string(name) + "=" + number_text(number->number());
  }
  for (const char* name : {"repeat", "from"}) {
    if (const auto value = field.find(name)) text += "," + std::string(name) + "=" + value->text();
  }
  field.within([&] {
    if (!volume_name(text)) throw InputError("volume: found '" + text + "', allowed is the name of a file .npz");
  });
  return text;
}

// A text as parse_material reads it, or an object of the same fields with "name"; or a volume.
std::string material_from(const JsonField& field) {
  std::string text;
  if (field.value().is_object() && field.value().contains("volume")) {
    text = volume_from(field);
  } else if (field.value().is_object()) {
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

std::map<std::string, std::string> materials_from(const JsonField& field) {
  std::map<std::string, std::string> materials;
  for (const JsonField& material : field.members("an object of materials by the names of bodies")) {
    const std::string name = material.path().substr(field.path().size() + 1);
    if (!is_body_name(name)) material.refuse("the name of a body as a key");
    materials[name] = material_from(material);
  }
  return materials;
}

BodyPoses placements_from(const JsonField& field) {
  BodyPoses poses;
  for (const JsonField& pose : field.members("an object of placements by the names of bodies")) {
    const std::string name = pose.path().substr(field.path().size() + 1);
    if (!is_body_name(name)) pose.refuse("the name of a body as a key");
    pose.allow({"position", "rotation"});
    if (const auto position = pose.find("position")) poses[name].position = position->precise_triple();
    if (const auto rotation = pose.find("rotation")) poses[name].rotation = rotation->precise_triple();
    pose.within([&] { check_pose(poses[name]); });
  }
  return poses;
}

Json placements_json(const BodyPoses& poses) {
  Json json = Json::object();
  for (const auto& [name, pose] : poses) {
    const glm::dvec3 &p = pose.position, &r = pose.rotation;
    json[name] = {{"position", {p.x, p.y, p.z}}, {"rotation", {r.x, r.y, r.z}}};
  }
  return json;
}

OptionValue value_from(const SceneOption& option, const JsonField& field) {
  constexpr double all = std::numeric_limits<float>::max();
  switch (option.kind) {
    case OptionKind::flag:
      return field.truth();
    case OptionKind::whole:
      return field.whole(static_cast<std::uint32_t>(option.range.low), static_cast<std::uint32_t>(option.range.high));
    case OptionKind::share:
    case OptionKind::number:
      return field.number(-all, all);
    case OptionKind::number_or_text:
      return field.value().is_number() ? OptionValue(field.number(-all, all)) : OptionValue(field.text());
    default:
      return field.text();
  }
}

Json value_json(const OptionValue& value) {
  return std::visit(
      [](const auto& alternative) -> Json {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(alternative)>, std::monostate>) {
          return nullptr;
        } else {
          return alternative;
        }
      },
      value);
}

// The options that a scene file has directly in the object at `pointer`, but for those of a form of their own.
std::vector<const SceneOption*> members_of(std::string_view pointer) {
  std::vector<const SceneOption*> members;
  for (const SceneOption& option : scene_options()) {
    const std::size_t end = option.member.rfind('/');
    if (end != std::string_view::npos && !option.own_form && option.member.substr(0, end) == pointer) {
      members.push_back(&option);
    }
  }
  return members;
}

std::string_view key_of(const SceneOption& option) {
  return option.member.substr(option.member.rfind('/') + 1);
}

// Reads the options at `pointer` from `field`, which has no other members but `others`.
void read_members(const JsonField& field, std::string_view pointer, std::initializer_list<std::string_view> others,
                  Scene& scene) {
  const std::vector<const SceneOption*> members = members_of(pointer);
  std::vector<std::string_view> keys;
  for (const SceneOption* option : members) keys.push_back(key_of(*option));
  keys.insert(keys.end(), others.begin(), others.end());
  field.allow(keys);
  for (const SceneOption* option : members) {
    const auto given = field.find(key_of(*option));
    if (!given) continue;
    const OptionValue value = value_from(*option, *given);
    given->within([&] { option->set(scene, value); });
  }
}

Json members_json(std::string_view pointer, const Scene& scene) {
  Json json = Json::object();
  for (const SceneOption* option : members_of(pointer)) {
    const OptionValue value = option->get(scene);
    if (value.index() > 0) json[std::string(key_of(*option))] = value_json(value);
  }
  return json;
}

void view_from(const JsonField& field, Scene& scene) {
  read_members(field, "/camera", {"target", "eye", "look_at"}, scene);
  if (const auto target = field.find("target")) scene.view.target = target->triple();
  if (const auto eye = field.find("eye")) scene.view.eye = eye->triple();
  if (const auto look_at = field.find("look_at")) scene.view.look_at = look_at->triple();
  field.within([&] { check_view(scene.view); });
}

Json view_json(const Scene& scene) {
  Json json = members_json("/camera", scene);
  if (scene.view.target != glm::vec3(0)) json["target"] = triple_json(scene.view.target);
  if (scene.view.eye) json["eye"] = triple_json(*scene.view.eye);
  if (scene.view.look_at) json["look_at"] = triple_json(*scene.view.look_at);
  return json;
}

void solve_from(const JsonField& field, Scene& scene) {
  read_members(field, "/solver", {"path"}, scene);
  if (const auto path = field.find("path")) read_members(*path, "/solver/path", {}, scene);
  field.within([&] { check_options(scene.solve); });
}

Json solve_json(const Scene& scene) {
  Json json = members_json("/solver", scene);
  json["path"] = members_json("/solver/path", scene);
  return json;
}

void plain_background_from(const JsonField& field, ToneOptions& tone) {
  const std::string text = numbers(field);
  field.within([&] { parse_background(text, tone); });
}

// One end of a gradient.
ToneOptions end_from(const JsonField& field) {
  ToneOptions end;
  plain_background_from(field, end);
  if (end.transparent) field.refuse("a grey or R/G/B in [0, 1]");
  return end;
}

void background_from(const JsonField& field, ToneOptions& tone) {
  if (!field.value().is_object()) return plain_background_from(field, tone);
  field.allow({"top", "bottom"});
  tone.background_top = end_from(field.at("top")).background_top;
  tone.background_bottom = end_from(field.at("bottom")).background_bottom;
  tone.transparent = false;
}

RoughnessMap roughness_map_from(const JsonField& field) {
  field.allow({"image", "placement", "roughness"});
  RoughnessMap map{image_from(field.at("image")), placement_from(field.at("placement"))};
  if (const auto roughness = field.find("roughness")) map.roughness = roughness->real();
  return map;
}

NormalMap normal_map_from(const JsonField& field) {
  field.allow({"image", "placement", "strength"});
  const JsonField image = field.at("image");
  const std::string file = image.text();
  NormalMap map{image.within([&] { return load_normal_map(file); })};
  if (const auto placement = field.find("placement")) map.placement = placement_from(*placement);
  if (const auto strength = field.find("strength")) map.strength = strength->real();
  return map;
}

void picture_from(const JsonField& field, Scene& scene) {
  read_members(field, "/picture", {"roughness_map", "normal_map", "background"}, scene);
  if (const auto map = field.find("roughness_map")) scene.render.roughness_map = roughness_map_from(*map);
  if (const auto map = field.find("normal_map")) scene.render.normal_map = normal_map_from(*map);
  if (const auto background = field.find("background")) background_from(*background, scene.tone);
  field.within([&] {
    check_options(scene.render);
    check_options(scene.tone);
  });
}

Json picture_json(const Scene& scene) {
  Json json = members_json("/picture", scene);
  if (const auto& map = scene.render.roughness_map) {
    json["roughness_map"] = {{"image", to_json(*map->image)},
                             {"placement", to_json(map->placement)},
                             {"roughness", real_json(map->roughness)}};
  }
  if (const auto& map = scene.render.normal_map) {
    json["normal_map"] = {{"image", to_json(*map->slopes)}, {"strength", real_json(map->strength)}};
    if (map->placement) json["normal_map"]["placement"] = to_json(*map->placement);
  }
  const ToneOptions& tone = scene.tone;
  json["background"] = "transparent";
  if (!tone.transparent) {
    json["background"] = {{"top", rgb_json(tone.background_top)}, {"bottom", rgb_json(tone.background_bottom)}};
  }
  return json;
}

}  // namespace

const std::string& said_material(const Scene& scene, const std::string& body) {
  const auto own = scene.materials.find(body);
  return own == scene.materials.end() ? scene.material : own->second;
}

Scene scene_from(const JsonField& document) {
  Scene scene;
  scene.body = document.at("body").text();
  if (const auto material = document.find("material")) scene.material = material_from(*material);
  if (const auto materials = document.find("materials")) scene.materials = materials_from(*materials);
  if (const auto placements = document.find("placements")) scene.placements = placements_from(*placements);
  if (const auto edits = document.find("edits")) scene.layers = layers_from(*edits);
  if (const auto lights = document.find("lights")) {
    const std::vector<JsonField> items = lights->items();
    lights->within([&] { check_light_count(items.size()); });
    for (const JsonField& light : items) scene.lights.push_back(light_from(light));
  }
  if (const auto deformation = document.find("deformation")) {
    for (const JsonField& deformer : deformation->items()) scene.deformation.push_back(deformer_from(deformer));
  }
  if (const auto cuts = document.find("cuts")) {
    for (const JsonField& cut : cuts->items()) scene.cuts.push_back(cut_from(cut));
  }
  if (const auto camera = document.find("camera")) view_from(*camera, scene);
  if (const auto solver = document.find("solver")) solve_from(*solver, scene);
  if (const auto picture = document.find("picture")) picture_from(*picture, scene);
  return scene;
}

Json to_json(const Scene& scene) {
  Json lights = Json::array(), deformation = Json::array(), cuts = Json::array();
  for (const Deformer& deformer : scene.deformation) deformation.push_back(to_json(deformer));
  for (const BodyCut& cut : scene.cuts) cuts.push_back(to_json(cut));
  for (const Light& light : scene.lights) lights.push_back(to_json(light));
  Json json = {{"quadgraph_scene", 1}, {"body", scene.body.string()}, {"material", scene.material}};
  if (!scene.materials.empty()) json["materials"] = scene.materials;
  if (!scene.placements.empty()) json["placements"] = placements_json(scene.placements);
  json["edits"] = layers_json(scene.layers);
  json["lights"] = std::move(lights);
  json["deformation"] = std::move(deformation);
  json["cuts"] = std::move(cuts);
  json["camera"] = view_json(scene);
  json["solver"] = solve_json(scene);
  json["picture"] = picture_json(scene);
  return json;
}

}  // namespace quadgraph
