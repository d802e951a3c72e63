// What a user does to the layers of strokes. `active` is the number of the layer that is painted, of which the panel
// shows the name and the opacity.
#pragma once

#include "engine/scene/scene.h"

namespace quadgraph {

// An empty layer above the active one, which becomes the active one; none where the scene has as many as it may.
void add_layer(Scene& scene, std::size_t& active);

// Takes the active layer away, with its strokes.
void remove_layer(Scene& scene, std::size_t& active);

// Moves the active layer a place up, nearer to the eye, or down.
void move_layer(Scene& scene, std::size_t& active, bool up);

// The number of the topmost layer; 0 where there is none.
std::size_t topmost(const Scene& scene);

// A scene that undo has changed may have fewer layers: the active one is then the topmost.
void keep_active(const Scene& scene, std::size_t& active);

}  // namespace quadgraph
