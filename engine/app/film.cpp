#include "engine/app/film.h"

#include <cmath>
#include <fstream>

#include "engine/base/error.h"
#include "engine/base/json_text.h"
#include "engine/base/regular_file.h"
#include "engine/scene/json_field.h"

namespace quadgraph {
namespace {

constexpr std::uintmax_t most_bytes = 65536;  // of what is said of progress
constexpr double most_seconds = 1e9;
constexpr std::uint32_t most_frames_of_film = 1000000;
constexpr std::string_view error_begins = "quadgraph: error: ";
constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=+./:,%@";

// As --turn of `quadgraph turntable` calls it.
const char* turn_name(FilmOf of) {
  if (of == FilmOf::body) return "body";
  return of == FilmOf::light ? "light" : "camera";
}

}  // namespace

std::vector<std::string_view> film_names(bool with_frames) {
  std::vector<std::string_view> names{"a turning camera", "a turning body", "turning lights"};
  if (with_frames) names.emplace_back("the frames of the file");
  return names;
}

std::vector<std::string> film_command(const FilmChoice& choice, const FilmFiles& files, const std::string& device) {
  const bool turns = choice.of != FilmOf::frames;
  std::vector<std::string> words{"quadgraph", turns ? "turntable" : "render", files.scene.string()};
  const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  if (turns) {
    add({"--turn", turn_name(choice.of), "--frames", std::to_string(film_rate * std::uint32_t(choice.seconds))});
    add({"--seconds", std::to_string(choice.seconds)});
  } else {
    add({"--frames"});
  }
  if (!device.empty()) add({"--device", device});
  if (!files.progress.empty()) add({"--progress", files.progress.string()});
  add({"-o", files.film.string()});
  return words;
}

std::string shell_text(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    std::string quoted;
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    const bool bare = !word.empty() && word.find_first_not_of(plain) == std::string::npos;
    text += (text.empty() ? "" : " ") + (bare ? word : "'" + quoted + "'");
  }
  return text;
}

std::optional<FilmProgress> read_film_progress(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    const Json document = parse_json(text_of_regular_file(path, most_bytes, "progress"));
    const JsonField field(document, "");
    field.allow({"done", "frames", "seconds_left"});
    FilmProgress progress;
    progress.frames = field.at("frames").whole(1, most_frames_of_film);
    progress.done = field.at("done").whole(0, progress.frames);
    if (const auto left = field.find("seconds_left"); left && !left->value().is_null()) {
      progress.seconds_left = left->number(0, most_seconds);
    }
    return progress;
  } catch (const InputError& error) {
    throw InputError(path.string() + ": " + error.what());
  }
}

std::string film_text(const FilmProgress& progress) {
  std::string text = std::to_string(progress.done) + " of " + std::to_string(progress.frames) + " frames";
  if (!progress.seconds_left) return text;
  const auto seconds = static_cast<std::uint64_t>(std::lround(*progress.seconds_left));
  const std::uint64_t minutes = seconds / 60;
  if (minutes > 0) text += ", " + std::to_string(minutes) + " min";
  if (minutes < 10) text += (minutes > 0 ? " " : ", ") + std::to_string(seconds % 60) + " s";
  return text + " left";
}

std::string why_no_film(const std::filesystem::path& said, int status) {
  std::ifstream file(said);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  }
  if (status < 0) return "quadgraph was ended by signal " + std::to_string(-status);
  if (last.empty()) return "quadgraph ended with status " + std::to_string(status) + " and said nothing";
  return last.starts_with(error_begins) ? last.substr(error_begins.size()) : last;
}

}  // namespace quadgraph
