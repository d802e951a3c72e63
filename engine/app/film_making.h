// A film of a scene while `quadgraph` makes it beside the window.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "engine/app/child_program.h"
#include "engine/app/film.h"
#include "engine/scene/scene_file.h"

namespace quadgraph {

// A folder for the files of a run, of a name that nobody can foresee; gone with its owner.
class RunFolder {
 public:
  // Throws InputError.
  RunFolder();
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// Until it has ended, its destruction ends it, and leaves nothing of it.
class FilmMaking {
 public:
  // Begins. `device`: as of --device. Throws InputError, which names the command to run where quadgraph cannot be
  // started.
  FilmMaking(const SceneFile& scene, const FilmChoice& choice, std::filesystem::path film, const std::string& device);

  const std::filesystem::path& film() const { return film_; }

  // Looks how far it is, some times a second. Whether there is something new: what it says, or that it has ended.
  bool follow();

  // Tells it to end, which takes it a moment.
  void cancel();

  bool cancelled() const { return cancelled_; }
  bool ended() const { return ended_; }
  const std::string& trouble() const { return trouble_; }  // once it has ended: why there is no film; else empty
  std::string text() const;                                // how far it is
  float share() const;                                     // of the frames that are done

 private:
  using Clock = std::chrono::steady_clock;

  std::filesystem::path film_;
  RunFolder folder_;  // removed after the program has ended
  FilmProgress progress_;
  Clock::time_point looked_;
  bool cancelled_ = false, ended_ = false;
  std::string trouble_;
  std::unique_ptr<ChildProgram> program_;
};

}  // namespace quadgraph
