// An engine that shows a scene.
#pragma once

#include <memory>

#include "engine/scene/scene.h"

namespace quadgraph {

class Stage {
 public:
  explicit Stage(const vk::ContextOptions& device = {}) : device_(device) {}

  // Sets on the engine what differs from the scene before; another body gets another engine. Throws FormatError,
  // InputError, VulkanError; the scene before then stays as far as it was not changed.
  void show(const Scene& scene);

  // Of the scene that is shown; as solve_measured, with its options or others, and Engine::render. Throw InputError
  // before there is one.
  SolveReport solve();
  SolveReport solve(const SolveOptions& options);
  Picture render();
  Engine& engine();
  const Scene& scene() const { return scene_; }

 private:
  vk::ContextOptions device_;
  std::unique_ptr<Engine> engine_;
  Scene scene_;
};

}  // namespace quadgraph
