// An engine that shows a scene.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "engine/render/in_use.h"
#include "engine/scene/scene.h"

namespace quadgraph {

class Stage {
 public:
  // Opens a device for every body, or takes one that is open.
  explicit Stage(const device::DeviceOptions& options = {}) : options_(options) {}
  explicit Stage(std::shared_ptr<device::Device> device) : device_(std::move(device)) {}

  // A body that has been loaded: the next scene is shown with it where it is of this file.
  struct Loaded {
    std::filesystem::path path;
    std::shared_ptr<const QuadGraph> body;
  };

  // Throws FormatError, InputError.
  static Loaded load(const std::filesystem::path& path);
  void take_up(Loaded body) { loaded_ = std::move(body); }

  // Makes the engine of what was taken up beside the one that is shown, which may be asked meanwhile, for the next
  // scene to take its place. Where the device has no room for both, that scene makes it. Throws FormatError,
  // InputError.
  void prepare();

  // The body that is shown. Throws InputError before a scene was.
  Loaded loaded() { return {scene_.body, engine().shared_graph()}; }

  // Sets on the engine what differs from the scene before; another body gets another engine. Throws FormatError,
  // InputError, DeviceError; the scene before then stays as far as it was not changed.
  void show(const Scene& scene);

  // Solve and render the scene that is shown, with its own options or others; see solve_measured and Engine::render.
  // Throw InputError before a scene was shown.
  SolveReport solve(const std::function<void()>& check = {});
  SolveReport solve(const SolveOptions& options, const std::function<void()>& check = {});
  Picture render(const std::function<void(const ConvergenceStep&)>& told = {});
  Engine& engine();
  const Scene& scene() const { return scene_; }

  // The stage for this thread alone, for what reads its engine, until that ends. Throws InputError where another
  // thread has it.
  [[nodiscard]] InUse::Turn take() { return in_use_.take(); }

  // What is to be said of the map that carried the material into the body; empty without one.
  const std::string& map_report() const { return map_report_; }

  // That all bodies are on; null where each has opened its own.
  const std::shared_ptr<device::Device>& shared_device() const { return device_; }

 private:
  std::unique_ptr<Engine> engine_of(Loaded body) const;

  InUse in_use_{"stage"};
  device::DeviceOptions options_;
  std::shared_ptr<device::Device> device_;  // null: by the options
  Loaded loaded_;                           // for the next scene
  std::unique_ptr<Engine> engine_, prepared_;
  Scene scene_;
  std::string map_report_;
};

}  // namespace quadgraph
