// quadgraph-engine: shows a baked object in a window, or writes a picture of it, without Python.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <iostream>

#include "engine/app/options.h"
#include "engine/app/report.h"
#include "engine/app/show_window.h"
#include "engine/base/message.h"
#include "engine/render/picture/metadata.h"
#include "engine/scene/stage.h"

using namespace quadgraph;

namespace {

// The picture has been written, but the solve did not converge, the picture did not reach the error that it was to
// converge to, or, with --strict, the solve misses the error asked for.
constexpr int exit_unmet = 3;

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

// The exit code.
int write_one(const AppOptions& options) {
  Stages stages;
  Stage stage(options.device);
  stage.show(options.scene);
  Engine& engine = stage.engine();
  stages.end("load");
  if (options.scene.solve.method != Method::shortest_path) engine.update_irradiance();
  stages.end("irradiance");
  SolveReport solve = stage.solve();
  stages.end("solve");
  const Picture picture = stage.render([](const ConvergenceStep& step) { std::cerr << step_text(step) << std::endl; });
  if (picture.convergence) {
    const std::string budget = solve.budget;
    solve = picture.convergence->solve;
    solve.budget = budget;
  }
  stages.end("render");
  write_picture(options, picture, engine.metadata());
  stages.end("write");
  refuse_messages(engine.device());
  const Metadata metadata = with_exposure(engine.metadata(), picture, options.scene.tone);
  const RunReport report{engine, solve, metadata, picture, options.output.string(), stages.wall_ms};
  std::cout << (options.json ? json_report(report) : text_report(report)) << "\n";
  const bool unmet = picture.convergence && !picture.convergence->reached;
  return unmet || fails(solve, options.strict) ? exit_unmet : EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    int exit_code = EXIT_SUCCESS;
    const auto options = parse_command_line(argc, argv, exit_code);
    if (!options) return exit_code;
    return options->headless ? write_one(*options) : show_window(*options);
  } catch (const std::exception& error) {
    std::string line = shortened(error.what());
    std::replace(line.begin(), line.end(), '\n', ' ');
    std::cerr << "quadgraph-engine: " << line << "\n";
    return EXIT_FAILURE;
  }
}
