#include "engine/app/modes.h"

#include <utility>

namespace quadgraph {

void take_brush(State& state, bool on) {
  state.brush.on = on;
  if (on) state.knife.on = false;
}

void take_knife(State& state, bool on) {
  state.knife.on = on;
  if (on) state.brush.on = false;
}

bool leave_mode(State& state) {
  if (std::exchange(state.help, false)) return true;
  if (std::exchange(state.compares_by_key, false)) return true;
  if (std::exchange(state.turntable, false)) return true;
  const bool brush = std::exchange(state.brush.on, false), knife = std::exchange(state.knife.on, false);
  return brush || knife;
}

void keep_method(State& state) {
  SolveOptions& solve = state.scene.solve;
  Show& show = state.scene.render.show;
  const bool cutting = state.knife.on || !state.scene.cuts.empty();
  if (cutting && solve.method != Method::shortest_path) {
    state.uncut = Uncut{solve.method, solve.active_layers, show};
    solve.method = Method::shortest_path;
    solve.active_layers = 0;
    show = {};
  } else if (!cutting && state.uncut) {
    solve.method = state.uncut->method;
    solve.active_layers = state.uncut->active_layers;
    if (show == Show{}) show = state.uncut->show;
    state.uncut.reset();
  }
}

}  // namespace quadgraph
