// Painting a material onto a body.
#pragma once

#include "engine/graph/edit.h"
#include "engine/scene/scene.h"

namespace quadgraph {

struct Brush {
  bool on = false;  // a left drag paints
  Edit edit{};      // what a stroke does, without its points

  // Reaching a fifteenth of `radius`, the body's, around the pointer and as deep, and multiplying absorption by three.
  static Brush for_body(float radius);

  // Begins a stroke at a point of the body at rest, mm, or leads it there if that is far enough from its last point.
  void begin(Scene& scene, const glm::vec3& at) const;
  void lead(Scene& scene, const glm::vec3& at) const;
};

}  // namespace quadgraph
