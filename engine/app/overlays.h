// What lies over the picture: the keys, what the colours mean, and the last message.
#pragma once

#include "engine/app/state.h"
#include "engine/render/display/outline.h"
#include "engine/render/picture/legend.h"

namespace quadgraph {

// The keys, over the picture.
void draw_help(State& state, float unit);

// What the colours mean, over the picture's lower edge. `left`: where the picture begins, window coordinates. Returns
// how far up it reaches.
float draw_colour_bar(const Legend& legend, float left, float unit);

// What the picture shows in the place of the body, over it; nothing if that is empty.
void draw_preview(const std::string& text, float left, float unit);

// How far a picture has converged, in the same place; nothing if that is empty.
void draw_convergence(const std::string& text, float left, float unit);

// The last thing to tell the user, in the picture's lower left corner, `above` what lies there.
void draw_message(const State& state, float left, float unit, float above);

// How far the film is that is being made, in the picture's upper right corner, with a button that ends it.
void draw_film(State& state, float unit);

// Whether to save before the window closes, in the middle.
void draw_question(State& state, float unit);

// The edge of the brush, clip coordinates, around a spot of its colour.
void draw_ring(const std::vector<glm::vec2>& ring, const glm::vec3& linear, float left, float unit);

// The edge of the body that was chosen, over the picture.
void draw_outline(const std::vector<Segment>& outline, float left, float unit);

// The way of the knife over the picture, which begins at `left`.
void draw_knife(const Knife& knife, float left, float unit);

}  // namespace quadgraph
