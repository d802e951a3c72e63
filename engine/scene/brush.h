// Painting a material onto a body.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/names.h"
#include "engine/scene/material_look.h"
#include "engine/scene/mirror.h"
#include "engine/scene/scene.h"

namespace quadgraph {

// Where the brush touches a body, and on the other side where it paints both.
struct Touch {
  TouchPlace here;
  std::optional<TouchPlace> mirrored{};
  std::string body{};  // its name; empty of a file of one
};

// Where the brush touches what was picked in a picture seen from `camera`.
TouchPlace touched(const Picked& picked, const Camera& camera);

enum class BrushTool { paint, erase, pick };

template <>
struct Names<BrushTool> {
  static constexpr std::string_view what = "tool";
  static constexpr auto values =
      std::to_array<Named<BrushTool>>({{BrushTool::paint, "paint", "a stroke along the drag"},
                                       {BrushTool::erase, "erase", "takes away the last stroke there"},
                                       {BrushTool::pick, "pick", "takes up the colour that is there"}});
};

struct Brush {
  bool on = false;  // a left drag paints
  BrushTool tool = BrushTool::paint;
  bool by_colour = true;  // what a stroke puts there is of `look`; else `edit` says what it does
  MaterialLook look{.colour = {0.55f, 0.04f, 0.03f}};  // without index, which stays the body's
  float strength = 1;           // how far it goes there from the colour of the body's material, 0 to 1
  Mirror mirror = Mirror::off;  // it paints on both sides
  Edit edit{};                  // what a stroke does, without its points; with an image or a mask it stamps these

  // Reaching a fifteenth of `radius`, the body's, around the pointer and as deep: red, in which light goes a quarter of
  // that depth.
  static Brush for_body(float radius);

  bool stamps() const { return edit.image || edit.mask; }

  // Begins a stroke of a layer that the scene has, where the brush touches the body, or leads its last one there if
  // that is far enough from its last point. A stamp is `edit.radius` to either side of where the brush touches, and
  // goes with it until it is let go. What is painted on both sides is one stroke.
  void begin(Scene& scene, std::size_t layer, const Touch& touch) const;
  void lead(Scene& scene, std::size_t layer, const Touch& touch) const;

  // What a touch does by the tool, to `layer` of the scene, where one is made if there is none. Whether a drag goes on
  // with it: picking up a colour ends with the touch, and paints next. Throws InputError, and changes nothing, where
  // the layer is hidden.
  bool touch(Scene& scene, std::size_t& layer, const Touch& touch);

  // And on the way of that drag.
  void go_on(Scene& scene, std::size_t layer, const Touch& touch) const;

  // Takes away the last stroke or stamp of the layer that reaches there, on both its sides, if there is one.
  static void erase(EditLayer& layer, const Touch& touch);

  // Takes up the colour that was painted there last in a layer that is seen, the topmost such layer first, or that of
  // the material.
  void pick(const Scene& scene, const Touch& touch);

 private:
  Edit stroke_on(const Scene& scene, const std::string& body) const;
  Edit stroke_at(const Scene& scene, const Touch& touch) const;
  Placement placement_at(const TouchPlace& place) const;
};

}  // namespace quadgraph
