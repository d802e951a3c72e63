// Painting a material onto a body.
#pragma once

#include "engine/app/material_look.h"
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

enum class BrushTool { paint, erase, pick };

struct Brush {
  bool on = false;  // a left drag paints
  BrushTool tool = BrushTool::paint;
  bool by_colour = true;  // what a stroke puts there is of `look`; else `edit` says what it does
  MaterialLook look{.colour = {0.55f, 0.04f, 0.03f}};  // without index, which stays the body's
  float strength = 1;  // how far it goes there from the colour of the body's material, 0 to 1
  Edit edit{};         // what a stroke does, without its points; with an image or a mask it stamps these

  // Reaching a fifteenth of `radius`, the body's, around the pointer and as deep: red, in which light goes a quarter of
  // that depth.
  static Brush for_body(float radius);

  bool stamps() const { return edit.image || edit.mask; }

  // Begins a stroke where the brush touches the body, or leads it there if that is far enough from its last point. A
  // stamp is `edit.radius` to either side of where the brush touches, and goes with it until it is let go.
  void begin(Scene& scene, const Touch& touch) const;
  void lead(Scene& scene, const Touch& touch) const;

  // Takes away the last stroke or stamp that reaches there, if there is one.
  static void erase(Scene& scene, const Touch& touch);

  // Takes up the colour that was painted there last, or that of the material.
  void pick(const Scene& scene, const Touch& touch);

 private:
  Edit stroke_on(const Scene& scene) const;
  Edit stamp(const Edit& how, const Touch& touch) const;
};

}  // namespace quadgraph
