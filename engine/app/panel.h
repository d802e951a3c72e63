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

}  // namespace quadgraph
