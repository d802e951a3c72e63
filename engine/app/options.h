// The command line of quadgraph-engine.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/render/engine.h"
#include "engine/render/tone_map.h"

namespace quadgraph {

struct AppOptions {
  std::filesystem::path file;    // .qgraph
  std::filesystem::path output;  // .png or .exr
  std::string material = "marble";
  std::vector<Light> lights;  // never empty
  View view;
  SolveOptions solve;
  RenderOptions render;
  ToneOptions tone;
  vk::ContextOptions device;
  bool json = false;
};

// Empty if the program should end with `exit_code`: help or version was asked for, or CLI11 has reported a mistake.
// Throws InputError for a value out of range, or without --headless.
std::optional<AppOptions> parse_command_line(int argc, const char* const* argv, int& exit_code);

}  // namespace quadgraph
