// How the viewer saves a film: another program makes it, and the viewer shows how far that is.
#include <algorithm>

#include "engine/app/viewer.h"
#include "engine/base/error.h"

namespace quadgraph {
namespace {

// Films have even sides.
std::uint32_t even(std::uint32_t pixels) {
  return std::max(pixels & ~1u, 2u);
}

}  // namespace

// Of the scene as it is, as large as the picture, each frame of one solve.
SceneFile Viewer::filmed_scene() const {
  Scene scene = state_.scene;
  scene.render.width = even(part().width);
  scene.render.height = even(part().height);
  scene.render.converge = scene.render.time_limit = 0;
  const bool own = state_.film.of == FilmOf::frames && saving_.frames;
  return own ? saving_.frames->with(scene) : SceneFile(scene);
}

void Viewer::save_film() {
  try {
    if (preview_) throw InputError("a film can be saved once the body is baked: this is a preview");
    if (film_) throw InputError("a film is being made; Cancel film ends it");
    const auto& info = engine().device().info();
    std::filesystem::path path;
    do {
      path = saving_.stem.string() + "-" + std::to_string(++films_written_) + state_.film.suffix();
    } while (std::filesystem::exists(path));
    film_.emplace(filmed_scene(), state_.film, path, info.cpu ? device::processor : info.name);
    state_.say("");
  } catch (const DeviceError&) {
    throw;
  } catch (const std::exception& error) {
    state_.say(error.what(), true);
  }
  tell_film();
}

// Looks how far the film is, and says so.
void Viewer::follow_film() {
  if (!film_) return;
  try {
    if (!film_->follow()) return;
  } catch (const InputError& error) {
    state_.say(error.what(), true);
  }
  if (film_->ended()) {
    const bool there = film_->trouble().empty();
    if (there) state_.say("saved: " + film_->film().string());
    if (!there && film_->cancelled()) state_.say("no film: it was cancelled");
    if (!there && !film_->cancelled()) state_.say("no film: " + film_->trouble(), true);
    film_.reset();
  }
  tell_film();
}

void Viewer::cancel_film() {
  if (film_) film_->cancel();
  tell_film();
}

void Viewer::tell_film() {
  state_.filming = film_.has_value();
  state_.film_text = film_ ? film_->text() : "";
  state_.film_share = film_ ? film_->share() : 0;
  frames_wanted_ = 3;
}

}  // namespace quadgraph
