#include "engine/app/history.h"

namespace quadgraph {
namespace {

constexpr std::size_t most_kept = 1000;

Scene seen_as(Scene scene, const Scene& other) {
  scene.view = other.view;
  scene.render.show = other.render.show;
  return scene;
}

Scene step(const Scene& scene, Scene& now, std::vector<Scene>& from, std::vector<Scene>& to) {
  if (from.empty()) return scene;
  to.push_back(std::move(now));
  now = std::move(from.back());
  from.pop_back();
  return seen_as(now, scene);
}

}  // namespace

void History::note(const Scene& scene) {
  if (seen_as(now_, scene) == scene) return;
  past_.push_back(std::move(now_));
  if (past_.size() > most_kept) past_.erase(past_.begin());
  future_.clear();
  now_ = scene;
}

Scene History::undo(const Scene& scene) {
  return step(scene, now_, past_, future_);
}

Scene History::redo(const Scene& scene) {
  return step(scene, now_, future_, past_);
}

void History::change_all(const std::function<void(Scene&)>& change) {
  change(now_);
  for (Scene& scene : past_) change(scene);
  for (Scene& scene : future_) change(scene);
}

void History::refuse(const Scene& scene) {
  if (past_.empty() || seen_as(now_, scene) != scene) return;
  now_ = std::move(past_.back());
  past_.pop_back();
}

}  // namespace quadgraph
