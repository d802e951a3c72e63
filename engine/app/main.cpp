// quadgraph-engine: renders a baked object without Python and without a window.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <iostream>

#include "engine/app/options.h"
#include "engine/app/report.h"
#include "engine/graph/error.h"
#include "engine/render/metadata.h"

using namespace quadgraph;

namespace {

// The picture has been written, but its error is not what was asked for.
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
  write(options.output, picture, options.tone, metadata);
}

void refuse_messages(const vk::Context& context) {
  const auto& messages = context.validation_messages();
  if (!messages.empty()) {
    throw VulkanError(std::to_string(messages.size()) + " validation messages, the first: " + messages.front());
  }
}

// The exit code.
int run(const AppOptions& options) {
  Stages stages;
  Engine engine(options.file, options.device);
  stages.end("load");
  engine.set_material(options.material);
  engine.set_lights(options.lights);
  engine.update_irradiance();
  stages.end("irradiance");
  const SolveReport solve = engine.solve(options.solve);
  stages.end("solve");
  const Picture picture = engine.render(options.view, options.render);
  stages.end("render");
  write_picture(options, picture, engine.metadata());
  stages.end("write");
  refuse_messages(engine.context());
  const Metadata metadata = with_exposure(engine.metadata(), picture, options.tone);
  const RunReport report{engine, solve, metadata, options.output.string(), stages.wall_ms};
  std::cout << (options.json ? json_report(report) : text_report(report)) << "\n";
  return solve.missed.empty() ? EXIT_SUCCESS : exit_missed;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    int exit_code = EXIT_SUCCESS;
    const auto options = parse_command_line(argc, argv, exit_code);
    return options ? run(*options) : exit_code;
  } catch (const std::exception& error) {
    std::string line = error.what();
    std::replace(line.begin(), line.end(), '\n', ' ');
    std::cerr << "quadgraph-engine: " << line << "\n";
    return EXIT_FAILURE;
  }
}
