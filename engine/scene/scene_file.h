// A scene that may change from frame to frame, and its file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/scene/track.h"

namespace quadgraph {

inline constexpr std::uint32_t most_frames = 1000000;
inline constexpr double most_key_values = 1e8;  // that are read when a scene is checked at all keys of its tracks

class SceneFile {
 public:
  // Reads a JSON file and checks at every key of its tracks what they change. A relative body and relative images of
  // lights are looked for beside the file; a camera without azimuth looks at the body's front (engine/file/front.h),
  // and a scene that says nothing of lights gets default_lights of its first view. Throws InputError naming the file,
  // the path into it, what was found and what is allowed.
  static SceneFile load(const std::filesystem::path& path);

  // Parses JSON text: relative names are looked for beside `path`, which is not read, or where that is empty in the
  // working directory. Throws as `load`.
  static SceneFile parse(const std::string& text, const std::filesystem::path& path = {});

  // One that does not change.
  explicit SceneFile(const Scene& scene);

  // `value`, JSON, in place of what is at `pointer`, or as a new member; a text that is not JSON counts as a string. A
  // track that changes this value is left out. Throws InputError, and changes nothing, where the scene would be wrong,
  // or a track changes all of what the value is part of.
  void set(const std::string& pointer, const std::string& value);

  // The same frames of another scene: its tracks change that one's values. A camera that they move is that of the file,
  // wherever the other one looks from. Throws InputError where a track finds no place in the other scene.
  SceneFile with(const Scene& scene) const;

  std::uint32_t frames() const { return frames_; }
  double frames_per_second() const { return frames_per_second_; }

  // Throws InputError.
  Scene at(double frame) const;

  // Writes a temporary file beside `path` and renames it. The body and images stay the same files. Throws InputError
  // naming the file.
  void save(const std::filesystem::path& path) const;

 private:
  SceneFile(Json document, std::filesystem::path path);

  void leave_out_tracks_of(const std::string& pointer);
  void check();
  void check_keys() const;
  Scene shown(Json document) const;

  Json document_, still_;       // still_: without tracks
  std::filesystem::path path_;  // empty: of no file
  std::vector<Track> tracks_;
  std::uint32_t frames_ = 1;
  double frames_per_second_ = 24;
  float front_ = 0;  // of the body at frame 0, degrees: the azimuth of a camera that names none
  std::optional<View> first_view_;
};

}  // namespace quadgraph
