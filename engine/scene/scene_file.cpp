#include "engine/scene/scene_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "engine/base/atomic_file.h"
#include "engine/base/json_text.h"
#include "engine/base/regular_file.h"
#include "engine/base/text.h"
#include "engine/file/front.h"
#include "engine/render/light/studio.h"
#include "engine/scene/material_map.h"
#include "engine/scene/track_parts.h"
#include "engine/scene/usual_light.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t format_version = 1;

Json parsed(const std::string& text, const std::filesystem::path& path) {
  try {
    return parse_json(text);
  } catch (const InputError& error) {
    throw InputError(path.string() + ": " + error.what());
  }
}

// The member of that name, if it is a text.
std::vector<Json*> text_of(Json& object, const char* name) {
  if (!object.is_object() || !object.contains(name) || !object[name].is_string()) return {};
  return {&object[name]};
}

// The files in a material's text; one that is not understood stays as it is, for a complaint that says where it stands.
template <typename Function>
void rename_volume(Json& material, const Function& renamed) {
  try {
    std::optional<VolumeName> name = volume_name(material.get<std::string>());
    if (!name) return;
    name->file = renamed(name->file);
    if (name->map && !name->map->from.empty()) name->map->from = renamed(name->map->from);
    material = to_string(*name);
  } catch (const InputError&) {
    return;
  }
}

// The material of a scene, and those of its bodies.
std::vector<Json*> materials_of(Json& document) {
  std::vector<Json*> materials;
  if (document.contains("material")) materials.push_back(&document["material"]);
  if (document.contains("materials") && document["materials"].is_object()) {
    for (Json& material : document["materials"]) materials.push_back(&material);
  }
  return materials;
}

// The items of the array of that name, if it is one, and of such arrays in these, as layers of edits have them.
std::vector<Json*> items_of(Json& object, const char* name) {
  std::vector<Json*> items;
  if (!object.is_object() || !object.contains(name) || !object[name].is_array()) return items;
  for (Json& item : object[name]) {
    items.push_back(&item);
    if (item.is_object() && item.contains(name) && item[name].is_array()) {
      for (Json& inner : item[name]) items.push_back(&inner);
    }
  }
  return items;
}

// Replaces the files that a scene names: its body, volumes and the bodies that they are from, images of lights, edits
// and the surface, and shapes of deformers.
template <typename Function>
void each_file(Json& document, const Function& renamed) {
  std::vector<Json*> files = text_of(document, "body");
  for (Json* material : materials_of(document)) {
    if (material->is_string()) rename_volume(*material, renamed);
    for (const char* name : {"volume", "from"}) {
      for (Json* file : text_of(*material, name)) files.push_back(file);
    }
  }
  for (const auto& [list, name] :
       {std::pair{"lights", "file"}, {"edits", "image"}, {"edits", "mask"}, {"deformation", "shapes"}}) {
    for (Json* item : items_of(document, list)) {
      for (Json* file : text_of(*item, name)) {
        if (*file != studio_name) files.push_back(file);
      }
    }
  }
  for (const char* map : {"roughness_map", "normal_map"}) {
    if (document.contains("picture") && document["picture"].is_object() && document["picture"].contains(map)) {
      for (Json* file : text_of(document["picture"][map], "image")) files.push_back(file);
    }
  }
  for (Json* file : files) *file = renamed(std::filesystem::path(file->get<std::string>())).string();
}

}  // namespace

SceneFile::SceneFile(Json document, std::filesystem::path path)
    : document_(std::move(document)), path_(std::move(path)) {
  check();
}

SceneFile::SceneFile(const Scene& scene) : SceneFile(to_json(scene), {}) {}

SceneFile SceneFile::load(const std::filesystem::path& path) {
  return parse(text_of_regular_file(path, json_bytes, "a scene"), path);
}

SceneFile SceneFile::parse(const std::string& text, const std::filesystem::path& path) {
  if (path.empty()) return {parsed(text, "scene"), {}};
  try {
    return {parsed(text, path), path};
  } catch (const InputError& error) {
    const std::string said = error.what();
    throw InputError(said.starts_with(path.string()) ? said : path.string() + ": " + said);
  }
}

void SceneFile::check() {
  const JsonField field(document_, "");
  if (document_.is_object() && document_.contains("bodies")) {
    throw InputError(
        "/bodies: a scene of meshes, which the command quadgraph bakes; for this program and the engine bake them into "
        "one file, 'quadgraph bake SCENE.json -o NAME.qgraph', and name it as \"body\", and what they are made of as "
        "\"materials\"");
  }
  field.allow({"quadgraph_scene", "body", "material", "materials", "placements", "edits", "lights", "deformation",
               "cuts", "camera", "solver", "picture", "frames", "frames_per_second", "tracks"});
  if (const auto version = field.find("quadgraph_scene")) version->whole(format_version, format_version);
  tracks_.clear();
  front_ = 0;
  first_view_.reset();
  double last = 0;
  if (const auto tracks = field.find("tracks")) {
    for (const JsonField& track : tracks->items()) {
      tracks_.emplace_back(track);
      last = std::max(last, tracks_.back().keys().back().first);
    }
  }
  still_ = document_;
  still_.erase("tracks");
  frames_ = static_cast<std::uint32_t>(std::clamp(std::ceil(last) + 1, 1.0, double{most_frames}));
  if (const auto frames = field.find("frames")) frames_ = frames->whole(1, most_frames);
  if (const auto rate = field.find("frames_per_second")) frames_per_second_ = rate->number(1, 1000);
  front_ = front_of(at(0).body);
  first_view_ = at(0).view;
  check_keys();
}

void SceneFile::check_keys() const {
  const std::vector<TrackPart> parts = track_parts(still_, tracks_);
  double values = 0;
  for (const TrackPart& part : parts) values += part.values();
  if (values > most_key_values) {
    throw InputError("/tracks: found keys that change " + number_text(values) + " values in all, allowed are " +
                     number_text(most_key_values) + "; use fewer keys");
  }
  for (const TrackPart& part : parts) {
    for (double frame : part.frames) {
      try {
        shown(part.at(frame));
      } catch (const InputError&) {
        at(frame);  // which names the place in the whole scene
        throw;
      }
    }
  }
}

void SceneFile::set(const std::string& pointer, const std::string& value) {
  check_json(value);
  const Json read = Json::parse(value, nullptr, false);
  SceneFile changed = *this;
  changed.leave_out_tracks_of(pointer);
  put(changed.document_, pointer, read.is_discarded() ? Json(value) : read);
  changed.check();
  *this = std::move(changed);
}

// Tracks of the value at `pointer`, which would take its place in every frame.
void SceneFile::leave_out_tracks_of(const std::string& pointer) {
  for (std::size_t k = tracks_.size(); k-- > 0;) {
    const std::string& target = tracks_[k].target();
    if (target == pointer) document_["tracks"].erase(k);
    if (pointer.starts_with(target + "/")) {
      throw InputError(pointer + ": a track changes all of " + target +
                       ", in every frame; change it there, at /tracks/" + std::to_string(k));
    }
  }
}

SceneFile SceneFile::with(const Scene& scene) const {
  Json document = to_json(scene);
  each_file(document, [](const std::filesystem::path& file) { return std::filesystem::absolute(file); });
  const Json first = to_json(at(0));
  std::vector<std::string> kept{"frames", "frames_per_second", "tracks"};
  for (const Track& track : tracks_) {
    const std::string member(split(track.target(), '/').at(1));
    if (member == "camera" || first[member] == document[member]) kept.push_back(member);
  }
  for (const std::string& member : kept) {
    if (document_.contains(member)) document[member] = document_[member];
  }
  return {std::move(document), path_};
}

Scene SceneFile::at(double frame) const {
  Json document = still_;
  for (const Track& track : tracks_) track.apply(frame, document);
  return shown(std::move(document));
}

Scene SceneFile::shown(Json document) const {
  const auto body = JsonField(document, "").find("body");
  if (body && body->value() == "") body->refuse("the name of a .qgraph file");
  each_file(document,
            [&](const std::filesystem::path& file) { return file.is_relative() ? path_.parent_path() / file : file; });
  Scene scene = scene_from(JsonField(document, ""));
  if (!document.contains("/camera/azimuth"_json_pointer))
    scene.view.azimuth = first_view(front_, scene.view.up).azimuth;
  const bool goes_around = std::ranges::any_of(tracks_, [](const Track& track) {
    return track.target() == "/camera" || track.target().starts_with("/camera/");
  });
  if (goes_around && scene.view.framing == Framing::automatic) scene.view.framing = Framing::turned;
  light_unlit(scene, first_view_.value_or(scene.view),
              {.lights = document.contains("lights"), .ground = document.contains("/picture/ground"_json_pointer)});
  return scene;
}

void SceneFile::save(const std::filesystem::path& path) const {
  Json document = document_;
  each_file(document, [&](const std::filesystem::path& file) {
    if (!file.is_relative()) return file;
    return std::filesystem::proximate(path_.parent_path() / file, std::filesystem::absolute(path).parent_path());
  });
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream text(temporary, std::ios::binary);
    text << document.dump(2) << "\n";
    text.flush();
    if (!text) throw InputError("no room, or no right to write there");
  });
}

}  // namespace quadgraph
