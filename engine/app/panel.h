// The panel beside the picture: what is shown and measured, and everything that can be changed.
#pragma once

#include "engine/app/state.h"

namespace quadgraph {

// What the panel tells and cannot change.
struct PanelFacts {
  const Engine& engine;
  const Measured& measured;
  float unit;  // window coordinates per pixel of an ordinary display
};

// Width of the panel in pixels of an ordinary display.
inline constexpr float panel_width = 340;

// The widgets of a frame, between Interface::begin and Interface::draw.
void draw_panel(State& state, const PanelFacts& facts);

// The keys, over the picture.
void draw_help(State& state, float unit);

// What the colours mean, over the picture's lower edge. `left`: where the picture begins, window coordinates.
void draw_colour_bar(const Legend& legend, float left, float unit);

// The last thing to tell the user, in the picture's lower left corner.
void draw_message(const State& state, float left, float unit);

}  // namespace quadgraph
