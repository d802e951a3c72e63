#include "engine/app/history.h"

namespace quadgraph {
namespace {

constexpr std::size_t most_kept = 1000;

Scene step(const Scene& scene, Scene& now, std::vector<Scene>& from, std::vector<Scene>& to) {
  if (from.empty()) return scene;
  to.push_back(std::move(now));
  now = std::move(from.back());
  from.pop_back();
  return with_work(now, scene);
}

}  // namespace

Scene with_work(const Scene& scene, const Scene& other) {
  Scene result = scene;
  result.body = other.body;
  result.view = other.view;
  result.render.show = other.render.show;
  result.solve.method = other.solve.method;
  result.solve.active_layers = other.solve.active_layers;
  result.solve.solver = other.solve.solver;
  result.solve.source = other.solve.source;
  result.solve.model = other.solve.model;
  result.solve.path = other.solve.path;
  return result;
}

bool same_work(const Scene& one, const Scene& other) {
  return with_work(one, other) == other;
}

void History::note(const Scene& scene) {
  if (same_work(now_, scene)) return;
  past_.push_back(std::move(now_));
  if (past_.size() > most_kept) past_.erase(past_.begin());
  future_.clear();
  now_ = scene;
}

Scene History::undo(const Scene& scene) {
  return step(scene, now_, past_, future_);
}

Scene History::before(const Scene& scene) const {
  History copy(now_);
  copy.past_ = past_.empty() ? past_ : std::vector<Scene>{past_.back()};
  copy.note(scene);
  return copy.undo(scene);
}

Scene History::redo(const Scene& scene) {
  return step(scene, now_, future_, past_);
}

void History::refuse(const Scene& scene) {
  if (past_.empty() || !same_work(now_, scene)) return;
  now_ = std::move(past_.back());
  past_.pop_back();
}

}  // namespace quadgraph
