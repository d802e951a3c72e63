// What a film that the window saves shows, the command of `quadgraph` that makes it, and what that says of it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quadgraph {

enum class FilmOf { camera, body, light, frames };

inline constexpr std::array<int, 3> film_seconds{5, 10, 15};  // to choose from
inline constexpr std::uint32_t film_rate = 24;                // frames a second

struct FilmChoice {
  FilmOf of = FilmOf::camera;
  int seconds = 10;  // that a turn takes; frames of a scene take as long as it says
  bool gif = false;  // else H.264

  const char* suffix() const { return gif ? ".gif" : ".mp4"; }
};

// What is to be read in a list of these, in the order of the enum.
std::vector<std::string_view> film_names(bool with_frames);

// Files of a run.
struct FilmFiles {
  std::filesystem::path scene, film, progress;
};

// The words of the command that makes a film of a scene file. `device`: as of --device; empty: its own choice.
std::vector<std::string> film_command(const FilmChoice& choice, const FilmFiles& files, const std::string& device);

// The words with a space between each, in quotes where a shell would take them otherwise.
std::string shell_text(const std::vector<std::string>& words);

// How far a film is: what --progress of the command writes.
struct FilmProgress {
  std::uint32_t done = 0, frames = 0;
  std::optional<double> seconds_left;

  bool operator==(const FilmProgress&) const = default;
};

// Nothing if there is no such file yet. Throws InputError.
std::optional<FilmProgress> read_film_progress(const std::filesystem::path& path);

// "12 of 240 frames, 1 min 40 s left".
std::string film_text(const FilmProgress& progress);

// Why a command that ended with a status other than 0 did: its last line, or the status where it said nothing.
std::string why_no_film(const std::filesystem::path& said, int status);

}  // namespace quadgraph
