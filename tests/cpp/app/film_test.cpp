// Films that the window saves: the command that makes them, what that says, and the program beside the window.
#include "engine/app/film.h"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include "engine/app/child_program.h"
#include "engine/app/film_making.h"
#include "engine/base/error.h"

using namespace quadgraph;

namespace {

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

std::string content(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

int waited_for(ChildProgram& program) {
  while (!program.status()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return *program.status();
}

// Until the program has said something.
void wait_for_words(const std::filesystem::path& said) {
  while (content(said).empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace

TEST_CASE("the command of a film says what turns for how long, and of frames of a scene only that") {
  const FilmFiles files{"a b.json", "film.mp4", "progress.json"};
  const FilmChoice choice{.of = FilmOf::body, .seconds = 5};
  CHECK(shell_text(film_command(choice, files, "cpu")) ==
        "quadgraph turntable 'a b.json' --turn body --frames 120 --seconds 5 --device cpu --progress progress.json "
        "-o film.mp4");
  CHECK(shell_text(film_command({.of = FilmOf::frames}, {"scene.json", "it's.gif", {}}, "")) ==
        "quadgraph render scene.json --frames -o 'it'\\''s.gif'");
  CHECK(film_names(false).size() + 1 == film_names(true).size());
  CHECK(std::string(FilmChoice{.gif = true}.suffix()) == ".gif");
}

TEST_CASE("how far a film is, is read and said in words") {
  const RunFolder folder;
  const auto file = folder.path() / "progress.json";
  CHECK_FALSE(read_film_progress(file));
  write(file, R"({"done": 0, "frames": 48, "seconds_left": null})");
  CHECK(film_text(*read_film_progress(file)) == "0 of 48 frames");
  write(file, R"({"done": 12, "frames": 240, "seconds_left": 99.6})");
  CHECK(film_text(*read_film_progress(file)) == "12 of 240 frames, 1 min 40 s left");
  CHECK(film_text({.done = 3, .frames = 4, .seconds_left = 7.2}) == "3 of 4 frames, 7 s left");
  CHECK(film_text({.done = 3, .frames = 4, .seconds_left = 3599}) == "3 of 4 frames, 59 min left");
  for (const char* wrong : {"", "{", "[]", R"({"done": 5, "frames": 4})", R"({"done": 1})",
                            R"({"frames": 0, "done": 0})", R"({"done": 1, "frames": 2, "seconds_left": -1})"}) {
    write(file, wrong);
    CHECK_THROWS_AS(read_film_progress(file), InputError);
  }
}

TEST_CASE("why there is no film is the last that was said, or how the program ended") {
  const RunFolder folder;
  const auto said = folder.path() / "said.txt";
  CHECK(why_no_film(said, 127).find("status 127") != std::string::npos);
  write(said, "a warning\nquadgraph: error: film.mp4: needs PyAV\n\n");
  CHECK(why_no_film(said, 1) == "film.mp4: needs PyAV");
  CHECK(why_no_film(said, -9).find("signal 9") != std::string::npos);
}

TEST_CASE("a program beside this one has a lower priority, what it says is kept, and its status told") {
  const RunFolder folder;
  const auto said = folder.path() / "said.txt";
  ChildProgram program({"sh", "-c", "nice; echo 'to people' >&2; exit 3"}, said);
  CHECK(waited_for(program) == 3);
  std::istringstream words(content(said));
  int priority = 0;
  words >> priority;
  CHECK(priority == std::min(getpriority(PRIO_PROCESS, 0) + 10, 19));
  CHECK(content(said).find("to people") != std::string::npos);
  CHECK_THROWS_AS(ChildProgram({"no-such-program-of-quadgraph"}, said), InputError);
}

TEST_CASE("a program that is told to end cleans up, and ends with its owner") {
  const RunFolder folder;
  const auto said = folder.path() / "said.txt", left = folder.path() / "left";
  const std::string script = "trap 'rm -f \"$0\"; exit 7' TERM; touch \"$0\"; echo ready; while :; do sleep 0.01; done";
  {
    ChildProgram program({"sh", "-c", script, left.string()}, said);
    wait_for_words(said);
    CHECK(std::filesystem::exists(left));
    CHECK_FALSE(program.status());
    program.end();
    CHECK(waited_for(program) == 7);
    CHECK_FALSE(std::filesystem::exists(left));
  }
  {
    const ChildProgram program({"sh", "-c", script, left.string()}, said);
    wait_for_words(said);
    CHECK(std::filesystem::exists(left));
  }
  CHECK_FALSE(std::filesystem::exists(left));
}

namespace {

// What a shell's script in the place of quadgraph does, and what becomes of the film.
class FilmRun {
 public:
  // `script`: empty: there is no quadgraph.
  explicit FilmRun(const std::string& script) : path_(std::getenv("PATH")) {
    if (!script.empty()) {
      write(folder_.path() / "quadgraph", "#!/bin/sh\n" + script);
      std::filesystem::permissions(folder_.path() / "quadgraph", std::filesystem::perms::owner_all);
    }
    setenv("PATH", (folder_.path().string() + (script.empty() ? "" : ":" + path_)).c_str(), 1);
  }
  ~FilmRun() { setenv("PATH", path_.c_str(), 1); }

  std::filesystem::path film() const { return folder_.path() / "film.gif"; }

  std::unique_ptr<FilmMaking> begun() const {
    Scene scene;
    scene.body = std::filesystem::path(QUADGRAPH_TEST_DATA) / "tiny.qgraph";
    return std::make_unique<FilmMaking>(SceneFile(scene), FilmChoice{.gif = true}, film(), "cpu");
  }

  // Once it has ended.
  std::unique_ptr<FilmMaking> ended() const {
    auto making = begun();
    while (!making->ended()) making->follow();
    return making;
  }

 private:
  RunFolder folder_;
  std::string path_;
};

}  // namespace

TEST_CASE("a film is there, or why it is not is told") {
  const std::string last = "for film; do :; done; ";
  CHECK(FilmRun(last + "test -f \"$2\" && touch \"$film\"").ended()->trouble().empty());
  CHECK(FilmRun(last + "touch \"$film\"; exit 3").ended()->trouble().empty());  // a frame did not converge
  CHECK(FilmRun("echo quadgraph: error: needs PyAV >&2; exit 1").ended()->trouble() == "needs PyAV");
  CHECK(FilmRun("echo nothing is written").ended()->trouble() == "nothing is written");
  std::string said;
  try {
    FilmRun("").begun();
  } catch (const InputError& error) {
    said = error.what();
  }
  CAPTURE(said);
  CHECK(said.find("quadgraph, which is to be on the PATH") != std::string::npos);
  CHECK(said.find("run: quadgraph turntable SCENE.json --turn camera --frames 240 --seconds 10 -o film.gif") !=
        std::string::npos);
}

TEST_CASE("how far a film is, is followed, and a cancelled one ends") {
  const FilmRun run(
      "for word; do test \"$last\" = --progress && progress=\"$word\"; last=\"$word\"; done\n"
      "echo '{\"done\": 3, \"frames\": 12, \"seconds_left\": 8}' > \"$progress.new\"; mv \"$progress.new\" "
      "\"$progress\"\n"
      "trap 'exit 130' TERM; while :; do sleep 0.01; done");
  const auto making = run.begun();
  CHECK(making->text() == "film.gif: begins");
  while (!making->follow()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK(making->text() == "film.gif: 3 of 12 frames, 8 s left");
  CHECK(making->share() == doctest::Approx(0.25));
  making->cancel();
  while (!making->ended()) making->follow();
  CHECK(making->cancelled());
  CHECK_FALSE(making->trouble().empty());
}

TEST_CASE("a folder of a run goes with what is in it") {
  std::filesystem::path path;
  {
    const RunFolder folder, other;
    CHECK(folder.path() != other.path());
    path = folder.path();
    write(path / "scene.json", "{}");
  }
  CHECK_FALSE(std::filesystem::exists(path));
}
