// Painting a material onto a body.
#pragma once

#include "engine/optics/edit.h"
#include "engine/render/display/pick.h"
#include "engine/scene/scene.h"

namespace quadgraph {

// Where the brush touches a body, in its shape at rest.
struct Touch {
  glm::vec3 at{0};             // mm
  glm::vec3 inward{0, 0, -1};  // unit, against the normal
  glm::vec3 upright{0, 1, 0};  // unit, along the surface: what is upwards in the picture
};

// Where the brush touches what was picked in a picture seen from `camera`.
Touch touched(const Picked& picked, const Camera& camera);

struct Brush {
  bool on = false;  // a left drag paints
  Edit edit{};      // what a stroke does, without its points; with an image or a mask it stamps these

  // Reaching a fifteenth of `radius`, the body's, around the pointer and as deep, and multiplying absorption by three.
  static Brush for_body(float radius);

  bool stamps() const { return edit.image || edit.mask; }

  // Begins a stroke where the brush touches the body, or leads it there if that is far enough from its last point. A
  // stamp is `edit.radius` to either side of where the brush touches, and goes with it until it is let go.
  void begin(Scene& scene, const Touch& touch) const;
  void lead(Scene& scene, const Touch& touch) const;

 private:
  Edit stamp(const Touch& touch) const;
};

}  // namespace quadgraph
