// The command line of quadgraph-engine.
#pragma once

#include <filesystem>
#include <optional>

#include "engine/scene/scene_file.h"

namespace quadgraph {

struct AppOptions {
  Scene scene;                    // with lights
  std::optional<SceneFile> file;  // that it is of, where that has frames of its own
  bool headless = false;          // a picture, and no window
  std::filesystem::path output;   // headless: .png or .exr; else what pictures that the user asks for are called
  std::filesystem::path preview;  // the body is one, and this file says what becomes of it; else empty
  bool copy_body = false;         // scenes that the user saves get a copy of the body beside them
  device::DeviceOptions device;
  bool json = false;
  bool strict = false;  // headless: an error that is missed fails
};

// Empty if the program should end with `exit_code`: help or version was asked for, or CLI11 has reported a mistake.
// Throws InputError for a value out of range.
std::optional<AppOptions> parse_command_line(int argc, const char* const* argv, int& exit_code);

}  // namespace quadgraph
