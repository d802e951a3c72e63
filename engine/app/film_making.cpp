#include "engine/app/film_making.h"

#include <unistd.h>

#include <cstdlib>
#include <system_error>
#include <utility>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

constexpr std::chrono::milliseconds between_looks{200};
constexpr int there_unmet = 3;  // exit status: the film is there, but a solve did not converge

FilmFiles files_in(const std::filesystem::path& folder, const std::filesystem::path& film) {
  return {.scene = folder / "scene.json", .film = film, .progress = folder / "progress.json"};
}

std::filesystem::path said_in(const std::filesystem::path& folder) {
  return folder / "said.txt";
}

std::unique_ptr<ChildProgram> started(const SceneFile& scene, const FilmChoice& choice, const FilmFiles& files,
                                      const std::string& device) {
  scene.save(files.scene);
  try {
    return std::make_unique<ChildProgram>(film_command(choice, files, device), said_in(files.scene.parent_path()));
  } catch (const InputError& error) {
    const FilmFiles by_hand{.scene = "SCENE.json", .film = files.film.filename(), .progress = {}};
    throw InputError(
        std::string("a film is made by quadgraph, which is to be on the PATH; ") + error.what() +
        ". Where it is, save the scene (Ctrl+S) and run: " + shell_text(film_command(choice, by_hand, "")));
  }
}

}  // namespace

RunFolder::RunFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "quadgraph-film-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw InputError(name + ": cannot be made");
  path_ = name;
}

RunFolder::~RunFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

FilmMaking::FilmMaking(const SceneFile& scene, const FilmChoice& choice, std::filesystem::path film,
                       const std::string& device)
    : film_(std::move(film)), program_(started(scene, choice, files_in(folder_.path(), film_), device)) {}

bool FilmMaking::follow() {
  if (ended_ || Clock::now() - looked_ < between_looks) return false;
  looked_ = Clock::now();
  if (const std::optional<int> status = program_->status()) {
    ended_ = true;
    const bool there = (*status == 0 || *status == there_unmet) && std::filesystem::exists(film_);
    if (!there) trouble_ = why_no_film(said_in(folder_.path()), *status);
    return true;
  }
  const auto progress = read_film_progress(files_in(folder_.path(), film_).progress);
  return progress && std::exchange(progress_, *progress) != *progress;
}

void FilmMaking::cancel() {
  cancelled_ = true;
  program_->end();
}

std::string FilmMaking::text() const {
  if (cancelled_) return "the film is being ended";
  const std::string name = film_.filename().string() + ": ";
  return name + (progress_.frames > 0 ? film_text(progress_) : "begins");
}

float FilmMaking::share() const {
  return progress_.frames > 0 ? static_cast<float>(progress_.done) / static_cast<float>(progress_.frames) : 0;
}

}  // namespace quadgraph
