#include "engine/scene/scene_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "engine/render/atomic_file.h"
#include "engine/render/default_lights.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t format_version = 1;
constexpr std::uint32_t most_frames = 1000000;

Json parsed(const std::string& text, const std::filesystem::path& path) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    throw InputError(path.string() + ": no JSON at line " + std::to_string(1 + std::count(text.begin(), end, '\n')));
  }
}

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw InputError(path.string() + ": cannot be read");
  return text.str();
}

// Replaces the files of shapes that deformers name.
template <typename Function>
void each_shapes_file(Json& document, const Function& renamed) {
  if (!document.contains("deformation") || !document["deformation"].is_array()) return;
  for (Json& deformer : document["deformation"]) {
    if (!deformer.is_object() || !deformer.contains("shapes") || !deformer["shapes"].is_string()) continue;
    deformer["shapes"] = renamed(std::filesystem::path(deformer["shapes"].get<std::string>())).string();
  }
}

}  // namespace

SceneFile::SceneFile(Json document, std::filesystem::path path)
    : document_(std::move(document)), path_(std::move(path)) {
  check();
}

SceneFile::SceneFile(const Scene& scene) : SceneFile(to_json(scene), {}) {}

SceneFile SceneFile::load(const std::filesystem::path& path) {
  try {
    return {parsed(content(path), path), path};
  } catch (const InputError& error) {
    const std::string text = error.what();
    throw InputError(text.starts_with(path.string()) ? text : path.string() + ": " + text);
  }
}

void SceneFile::check() {
  const JsonField field(document_, "");
  field.allow({"quadgraph_scene", "body", "material", "edits", "lights", "deformation", "camera", "solver", "picture",
               "frames", "frames_per_second", "tracks"});
  if (const auto version = field.find("quadgraph_scene")) version->whole(format_version, format_version);
  tracks_.clear();
  first_view_.reset();
  std::set<double> keys{0};
  if (const auto tracks = field.find("tracks")) {
    for (const JsonField& track : tracks->items()) {
      tracks_.emplace_back(track);
      for (const auto& [frame, value] : tracks_.back().keys()) keys.insert(frame);
    }
  }
  frames_ = static_cast<std::uint32_t>(std::clamp(std::ceil(*keys.rbegin()) + 1, 1.0, double{most_frames}));
  if (const auto frames = field.find("frames")) frames_ = frames->whole(1, most_frames);
  if (const auto rate = field.find("frames_per_second")) frames_per_second_ = rate->number(1, 1000);
  first_view_ = at(0).view;
  for (double frame : keys) at(frame);
}

void SceneFile::set(const std::string& pointer, const std::string& value) {
  const Json read = Json::parse(value, nullptr, false);
  SceneFile changed = *this;
  put(changed.document_, pointer, read.is_discarded() ? Json(value) : read);
  changed.check();
  *this = std::move(changed);
}

Scene SceneFile::at(double frame) const {
  Json document = document_;
  for (const Track& track : tracks_) track.apply(frame, document);
  each_shapes_file(document, [&](const std::filesystem::path& shapes) {
    return shapes.is_relative() ? path_.parent_path() / shapes : shapes;
  });
  Scene scene = scene_from(JsonField(document, ""));
  if (!document.contains("lights")) scene.lights = default_lights(first_view_.value_or(scene.view));
  const std::filesystem::path folder = path_.parent_path();
  if (scene.body.is_relative()) scene.body = folder / scene.body;
  for (Light& light : scene.lights) {
    if (!light.file.empty() && !folder.empty()) light.file = folder / light.file;
  }
  return scene;
}

void SceneFile::save(const std::filesystem::path& path) const {
  Json document = document_;
  const auto move = [&](Json& file) {
    const std::filesystem::path old = file.get<std::string>();
    if (old.is_absolute()) return;
    file = std::filesystem::proximate(path_.parent_path() / old, std::filesystem::absolute(path).parent_path());
  };
  move(document["body"]);
  if (document.contains("lights")) {
    for (Json& light : document["lights"]) {
      if (light.contains("file")) move(light["file"]);
    }
  }
  each_shapes_file(document, [&](const std::filesystem::path& shapes) {
    if (!shapes.is_relative()) return shapes;
    return std::filesystem::proximate(path_.parent_path() / shapes, std::filesystem::absolute(path).parent_path());
  });
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file << document.dump(2) << "\n";
    file.flush();
    if (!file) throw InputError("no room, or no right to write there");
  });
}

}  // namespace quadgraph
