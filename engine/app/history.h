// What the scene was before, to go back to.
#pragma once

#include <vector>

#include "engine/scene/scene.h"

namespace quadgraph {

// `scene` in what is done to the body, its material, light and picture, `other` in all else: the body's file, the
// camera, the views of the inside, and by what it is solved.
Scene with_work(const Scene& scene, const Scene& other);

bool same_work(const Scene& one, const Scene& other);

// Only that work is part of it: going back leaves the eye and the method as they are.
class History {
 public:
  explicit History(Scene scene) : now_(std::move(scene)) {}

  // Notes the scene if its work differs from what was noted last.
  void note(const Scene& scene);

  // The scene noted before, or after the one that `undo` left, by all else as `scene` is; `scene` itself if there is
  // none.
  Scene undo(const Scene& scene);
  Scene redo(const Scene& scene);

  // What `undo` would give of `scene`.
  Scene before(const Scene& scene) const;

  // Forgets `scene`, which was noted last and cannot be shown.
  void refuse(const Scene& scene);

  bool can_undo() const { return !past_.empty(); }
  bool can_redo() const { return !future_.empty(); }

 private:
  Scene now_;
  std::vector<Scene> past_, future_;
};

}  // namespace quadgraph
