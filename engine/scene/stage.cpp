#include "engine/scene/stage.h"

#include <utility>

#include "engine/base/error.h"
#include "engine/devices/open_device.h"
#include "engine/scene/measured_error.h"
#include "engine/scene/volume.h"

namespace quadgraph {

Stage::Loaded Stage::load(const std::filesystem::path& path) {
  return {path, std::make_shared<const QuadGraph>(QuadGraph::load(path))};
}

std::unique_ptr<Engine> Stage::engine_of(Loaded body) const {
  return std::make_unique<Engine>(std::move(body.body), body.path, device_ ? device_ : open_device(options_));
}

void Stage::prepare() {
  if (engine_ && loaded_.path == scene_.body) return;  // it is shown
  try {
    prepared_ = engine_of(loaded_);
  } catch (const DeviceError&) {
  }
}

void Stage::show(const Scene& scene) {
  const auto turn = in_use_.take();
  Loaded loaded = std::exchange(loaded_, {});
  std::unique_ptr<Engine> prepared = std::move(prepared_);
  const bool fresh = !engine_ || scene.body != scene_.body;
  if (fresh) {
    engine_.reset();  // two bodies need not fit beside each other
    if (loaded.path != scene.body) {
      prepared.reset();
      loaded = load(scene.body);
    }
    engine_ = prepared ? std::move(prepared) : engine_of(std::move(loaded));
    scene_ = {};
    scene_.body = scene.body;
  }
  engine_->set_light_roughness(scene.render.light_roughness());
  if (fresh || scene.material != scene_.material || scene.materials != scene_.materials) {
    map_report_ = set_materials(*engine_, scene.material, scene.materials);
    scene_.material = scene.material;
    scene_.materials = scene.materials;
  }
  if (scene.layers != scene_.layers) {
    std::vector<Edit> edits = applied_edits(scene.layers);
    if (edits != applied_edits(scene_.layers)) engine_->set_edits(edits);
    scene_.layers = scene.layers;
  }
  if (fresh || scene.lights != scene_.lights) {
    engine_->set_lights(scene.lights);
    scene_.lights = scene.lights;
  }
  if (scene.deformation != scene_.deformation || scene.placements != scene_.placements) {
    engine_->set_shape(scene.deformation, scene.placements);
    scene_.deformation = scene.deformation;
    scene_.placements = scene.placements;
  }
  if (scene.cuts != scene_.cuts) {
    engine_->set_cuts(scene.cuts);
    scene_.cuts = scene.cuts;
  }
  engine_->set_normal_map(scene.render.normal_map);
  scene_ = scene;
}

SolveReport Stage::solve(const std::function<void()>& check) {
  return solve(scene_.solve, check);
}

SolveReport Stage::solve(const SolveOptions& options, const std::function<void()>& check) {
  const auto turn = in_use_.take();
  return solve_measured(engine(), options, check);
}

Picture Stage::render(const std::function<void(const ConvergenceStep&)>& told) {
  const auto turn = in_use_.take();
  Engine& shown = engine();
  try {
    return shown.render(scene_.view, scene_.render, told);
  } catch (const InputError& error) {  // what the body does not have, such as a level that is to be shown
    throw InputError(scene_.body.string() + ": " + error.what());
  }
}

Engine& Stage::engine() {
  if (!engine_) throw InputError("stage: no scene is shown yet");
  return *engine_;
}

}  // namespace quadgraph
