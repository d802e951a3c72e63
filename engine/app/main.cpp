// quadgraph-engine: shows a baked object in a window, or writes a picture of it, without Python.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <iostream>

#include "engine/app/options.h"
#include "engine/app/report.h"
#include "engine/app/viewer.h"
#include "engine/base/error.h"
#include "engine/devices/open_device.h"
#include "engine/render/picture/metadata.h"
#include "engine/scene/stage.h"

using namespace quadgraph;

namespace {

// The picture has been written, but what was asked of the solve is not met.
constexpr int exit_missed = 3;

// Wall time of the stages of a run.
class Stages {
 public:
  void end(const std::string& name) {
    const auto now = std::chrono::steady_clock::now();
    wall_ms.emplace_back(name, std::chrono::duration<double, std::milli>(now - start_).count());
    start_ = now;
  }

  std::vector<std::pair<std::string, double>> wall_ms;

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void write_picture(const AppOptions& options, const Picture& picture, const Metadata& metadata) {
  const auto write = options.output.extension() == ".exr" ? write_exr : write_png;
  write(options.output, picture, options.scene.tone, metadata);
}

void refuse_messages(const device::Device& context) {
  const auto& messages = context.validation_messages();
  if (!messages.empty()) {
    throw DeviceError(std::to_string(messages.size()) + " validation messages, the first: " + messages.front());
  }
}

// The exit code.
int write_one(const AppOptions& options) {
  Stages stages;
  Stage stage(options.device);
  stage.show(options.scene);
  Engine& engine = stage.engine();
  stages.end("load");
  if (options.scene.solve.method != Method::shortest_path) engine.update_irradiance();
  stages.end("irradiance");
  const SolveReport solve = stage.solve();
  stages.end("solve");
  const Picture picture = stage.render();
  stages.end("render");
  write_picture(options, picture, engine.metadata());
  stages.end("write");
  refuse_messages(engine.context());
  const Metadata metadata = with_exposure(engine.metadata(), picture, options.scene.tone);
  const RunReport report{engine, solve, metadata, options.output.string(), stages.wall_ms};
  std::cout << (options.json ? json_report(report) : text_report(report)) << "\n";
  return unmet(solve).empty() ? EXIT_SUCCESS : exit_missed;
}

// The Vulkan device that shows frames in a window; pictures may be made by another.
std::shared_ptr<vk::Context> presenter_of(const Window& window, device::DeviceOptions options) {
  options.surface = std::make_shared<vk::SurfaceSource>(window.surface());
  options.device = wanted_device(options);
  if (options.device == device::processor) options.device.clear();
  return std::make_shared<vk::Context>(options);
}

int show_window(const AppOptions& options) {
  const std::filesystem::path name = options.scene.body.filename();
  Window window(name.string() + " - QuadGraph", 1280, 800);
  const auto presenter = presenter_of(window, options.device);
  const std::string wanted = wanted_device(options.device);
  const bool on_processor = wanted.empty() ? presenter->info().cpu : wanted == device::processor;
  Stage stage(on_processor ? open_device({.device = device::processor}) : presenter);
  stage.show(options.scene);
  {
    const std::filesystem::path stem = options.output.empty() ? name.stem() : options.output;
    Viewer(window, *presenter, stage, stem).run();
  }
  refuse_messages(*presenter);
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    int exit_code = EXIT_SUCCESS;
    const auto options = parse_command_line(argc, argv, exit_code);
    if (!options) return exit_code;
    return options->headless ? write_one(*options) : show_window(*options);
  } catch (const std::exception& error) {
    std::string line = error.what();
    std::replace(line.begin(), line.end(), '\n', ' ');
    std::cerr << "quadgraph-engine: " << line << "\n";
    return EXIT_FAILURE;
  }
}
