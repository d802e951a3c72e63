// What the scene was before, to go back to.
#pragma once

#include <functional>
#include <vector>

#include "engine/scene/scene.h"

namespace quadgraph {

// The camera, and what of the body is shown, are not part of it: going back leaves the eye where it is.
class History {
 public:
  explicit History(Scene scene) : now_(std::move(scene)) {}

  // Notes the scene if it differs from what was noted last.
  void note(const Scene& scene);

  // The scene noted before, or after the one that `undo` left, seen as `scene` is; `scene` itself if there is none.
  Scene undo(const Scene& scene);
  Scene redo(const Scene& scene);

  // Forgets `scene`, which was noted last and cannot be shown.
  void refuse(const Scene& scene);

  // Changes the scene as it is noted at every time.
  void change_all(const std::function<void(Scene&)>& change);

  bool can_undo() const { return !past_.empty(); }
  bool can_redo() const { return !future_.empty(); }

 private:
  Scene now_;
  std::vector<Scene> past_, future_;
};

}  // namespace quadgraph
