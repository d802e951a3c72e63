// Everything that a key does. The help overlay and docs/window.md list the same.
#pragma once

#include <span>
#include <string_view>

#include "engine/app/state.h"

namespace quadgraph {

// What the commands need to know of the body and the picture.
struct CommandContext {
  Sphere bounds;
  float aspect = 1;                                  // of the picture, width / height
  std::uint32_t levels = 1;                          // of the body
  std::array<bool, knowledge_names.size()> known{};  // what of the material's certainty is stated
};

struct Command {
  std::string_view keys;  // as the help shows them
  int key, other_key;     // GLFW's; 0: none
  int mods;               // GLFW's, that must be held; others must not
  std::string_view text;  // what it does
  void (*run)(State&, const CommandContext&);
};

std::span<const Command> all_commands();

// Runs the command of a key, if it has one.
bool run_command(int key, int mods, State& state, const CommandContext& context);

}  // namespace quadgraph
