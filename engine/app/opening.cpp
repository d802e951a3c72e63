// What the viewer opens: files whose names are typed, or that are dropped onto the window.
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <future>
#include <thread>

#include "engine/app/environment_section.h"
#include "engine/app/panel_widgets.h"
#include "engine/app/viewer.h"
#include "engine/base/error.h"
#include "engine/file/front.h"
#include "engine/scene/layers.h"
#include "engine/scene/scene_file.h"

extern char** environ;

namespace quadgraph {
namespace {

constexpr std::array meshes{".obj", ".off", ".ply", ".stl", ".gltf", ".glb"};  // that quadgraph bakes
constexpr std::array skies{".hdr", ".exr", ".png"};

template <typename Names>
bool among(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string suffix_of(const std::filesystem::path& file) {
  std::string suffix = file.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return std::tolower(c); });
  return suffix;
}

// Another body under the light that is there.
Scene with_body(const std::filesystem::path& file, const Scene& before) {
  Scene scene = before;
  scene.body = file;
  scene.layers.clear();
  scene.placements.clear();
  scene.deformation.clear();
  scene.cuts.clear();
  scene.render.show = {};
  scene.view = first_view(front_of(file), before.view.up);
  return scene;
}

// A window of its own, which bakes it.
void view_mesh(const std::filesystem::path& mesh, float longest_mm) {
  const std::string size = formatted("%.6gmm", double{longest_mm});
  std::string words[] = {"quadgraph", "view", "--longest", size, mesh.string()};
  std::array<char*, std::size(words) + 1> arguments{};
  for (std::size_t i = 0; i < std::size(words); ++i) arguments[i] = words[i].data();
  pid_t child = 0;
  if (posix_spawnp(&child, "quadgraph", nullptr, nullptr, arguments.data(), environ) != 0) {
    throw InputError(mesh.string() +
                     ": a mesh is baked by quadgraph, which is not on the PATH; there run: quadgraph view " +
                     "--longest " + size + " " + mesh.string());
  }
  std::thread([child] { waitpid(child, nullptr, 0); }).detach();  // it ends by itself
}

}  // namespace

// Only where nothing is lost by that: leave_or_ask has asked.
void Viewer::open_file(const std::filesystem::path& file) {
  try {
    const std::string suffix = suffix_of(file);
    if (!std::filesystem::is_regular_file(file)) throw InputError(file.string() + ": is no file that can be read");
    if (among(meshes, suffix)) {
      view_mesh(file, state_.longest_mm);
      state_.say(file.filename().string() + " opens in a window of its own");
    } else if (among(skies, suffix)) {
      put_environment(state_.scene, file.string(), engine().bounds());
      state_.say("");
    } else if (suffix == ".qgraph") {
      prepare(file);
      show_opened(with_body(file, state_.scene), std::nullopt);
      window_.set_name(file.filename().string());
    } else if (suffix == ".json") {
      const SceneFile scenes = SceneFile::load(file);
      prepare(scenes.at(0).body);
      show_opened(scenes.at(0), scenes.frames() > 1 ? std::optional(scenes) : std::nullopt);
      window_.set_name(file.filename().string());
    } else {
      throw InputError(file.string() + ": found '" + suffix +
                       "', expected .qgraph, .json (a scene), a mesh (.obj, .off, " +
                       ".ply, .stl, .gltf, .glb) or a picture of surroundings (.hdr, .exr, .png)");
    }
  } catch (const DeviceError&) {
    throw;
  } catch (const std::exception& error) {
    state_.say(error.what(), true);
  }
  state_.keep();  // the answer to a question was of this file
  frames_wanted_ = 3;
}

// Loads a body, and makes its engine, beside what is shown and goes on being heard. Throws Interrupted where the window
// closes meanwhile.
void Viewer::prepare(const std::filesystem::path& body) {
  std::future<Stage::Loaded> loaded = std::async(std::launch::async, [&] { return Stage::load(body); });
  while (loaded.wait_for(hearing_pause) != std::future_status::ready) hear(false);
  stage_.take_up(loaded.get());
  forget_convergence();
  rest_.reset();  // the device has room for two bodies, not for three
  const device::Interruptible scope(engine().device());
  stage_.prepare();
}

// In the place of what is shown, which comes back where it cannot be shown.
void Viewer::show_opened(const Scene& scene, const std::optional<SceneFile>& frames) {
  const Scene before = state_.scene;
  const auto show = [&](const Scene& wanted) {
    forget_convergence();
    rest_.reset();
    shown_.reset();
    solved_ = false;
    state_.scene = wanted;
    remake(false);
    making_.reset();
  };
  try {
    show(scene);
  } catch (const DeviceError&) {
    throw;
  } catch (const std::exception&) {
    show(before);
    throw;
  }
  preview_.reset();
  state_.preview.clear();
  state_.uncut.reset();
  state_.light = state_.cut = 0;
  state_.layer = topmost(state_.scene);
  state_.brush = Brush::for_body(engine().bounds().radius);
  take_up_body();
  saving_.stem.replace_filename(scene.body.stem());
  saving_.frames = frames;
  state_.has_frames = frames.has_value();
  if (!frames && state_.film.of == FilmOf::frames) state_.film.of = FilmOf::camera;
  history_ = History(state_.scene);
  saved_ = state_.scene;
  changed_ = Clock::now();
  state_.say("");
}

}  // namespace quadgraph
