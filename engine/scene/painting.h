// Painting that is asked for in JSON, by a page in a browser: the same brush and layers that a hand in the window has.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "engine/scene/brush.h"
#include "engine/scene/json_field.h"
#include "engine/scene/picker.h"
#include "engine/scene/stage.h"

namespace quadgraph {

inline constexpr std::size_t most_touches = 64;  // of one painted()

struct Painted {
  Scene scene;
  std::size_t layer = 0;  // the active one
  MaterialLook look{};    // of the brush, which may have picked up another
  bool touched = false;   // the first place lies on a body
};

// {"tool": "paint", "colour": [.5, .04, .03], "distance": 1, "strength": 1, "radius": 4, "depth": 4, "falloff": 2,
// "mirror": "off", "layer": 0}: tool and layer as of Brush::touch, colour linear, lengths in mm. A brush that is read
// may have more: "depth_from"; "mask" and "pattern", files of images that it stamps; and "coefficients", which take the
// place of colour, distance and strength: {"operation": "multiply", "sigma_a": .5, "sigma_s_prime": [1, 1, 2]}.
Json to_json(const Brush& brush);

// The scene that the stage shows after such a brush has gone over `places` of its picture, pixels right and down from
// its corner: `begins` says that a drag does there, else it goes on. Throws InputError with the path of what is wrong,
// and where the layer is hidden.
Painted painted(Stage& stage, const JsonField& brush, std::span<const glm::vec2> places, bool begins);

// The rings that show how far such a brush reaches at a place of the picture, as Picker::rings, in pixels as above.
// Throws InputError with the path of what is wrong.
std::vector<Ring> brush_rings(Stage& stage, const JsonField& brush, const glm::vec2& pixels);

// After {"layer": 0, "change": "add"}, what layers.h does to the active layer: "add", "remove", "up", "down", or
// "name", "visible", "opacity" with a "value". Throws InputError with the path of what is wrong.
Painted relayered(const Scene& scene, const JsonField& asked);

// Clip coordinates of a place in the scene's picture, pixels right and down from its corner.
glm::vec2 clip_place(const Scene& scene, const glm::vec2& pixels);

// What a picture of the scene that the stage shows has there, pixels as above.
std::optional<Picked> picked_at(Stage& stage, const glm::vec2& pixels);

}  // namespace quadgraph
