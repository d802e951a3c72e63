#include "engine/render/engine.h"

#include "engine/base/text.h"
#include "engine/optics/body_size.h"
#include "engine/optics/material.h"
#include "engine/render/converging.h"
#include "engine/render/engine_implementation.h"
#include "engine/render/picture/legend.h"
#include "engine/render/picture/metadata.h"
#include "engine/render/picture/picture_error.h"
#include "engine/render/verdict.h"

namespace quadgraph {

Engine::Engine(const std::filesystem::path& path, const device::DeviceOptions& device)
    : Engine(path, open_device(device)) {}

Engine::Engine(const std::filesystem::path& path, std::shared_ptr<device::Device> device)
    : Engine(std::make_shared<const QuadGraph>(QuadGraph::load(path)), path, std::move(device)) {}

Engine::Engine(std::shared_ptr<const QuadGraph> body, const std::filesystem::path& path,
               std::shared_ptr<device::Device> device)
    : implementation_(std::make_unique<Implementation>(std::move(body), path, std::move(device))) {}

Engine::~Engine() = default;

const QuadGraph& Engine::graph() const {
  return implementation_->graph;
}

const std::shared_ptr<const QuadGraph>& Engine::shared_graph() const {
  return implementation_->shared_graph;
}

device::Device& Engine::device() const {
  return implementation_->device;
}

Simulation& Engine::simulation() {
  const auto turn = implementation_->in_use.take();
  return implementation_->levels();
}

const Sphere& Engine::bounds() const {
  return implementation_->bounds;
}

void Engine::set_material(std::string_view text) {
  const gpu::Material material = parse_material(text);
  set_material(material, {stated_coat(text), stated_roughness(text).value_or(default_roughness)});
  implementation_->material = text;
  implementation_->of_text = material;
}

void Engine::set_material(const gpu::Material& material, const Finish& finish) {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  check_material(material);
  if (self.simulation) self.simulation->set_material(material);
  self.paths.set(material);
  self.material = material_text(material);
  self.certainty = {};
  self.body_roughness.reset();
  self.set_surfaces({{double{material.eta}, finish.coat, finish.roughness}});
}

void Engine::set_optical(std::uint32_t level, std::span<const gpu::Optical> optical, float eta,
                         std::span<const gpu::Optical> elsewhere, const Coat& coat) {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  self.levels().set_optical(level, optical, eta, elsewhere);
  self.levels().set_etendue({});
  self.paths.clear();
  self.material = "coefficients per node, eta=" + number_text(eta);
  self.certainty = {};
  self.body_roughness.reset();
  self.set_surfaces({{double{eta}, coat, default_roughness}});
}

void Engine::set_optical(const OpticalGrid& grid, const Coat& coat) {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  check_optical(grid.optical, grid.optical.size());
  check_eta(static_cast<double>(grid.eta));
  self.paths.set(grid);
  self.material = "coefficients on a grid, eta=" + number_text(grid.eta);
  self.certainty = {};
  self.body_roughness.reset();
  self.set_surfaces({{double{grid.eta}, coat, default_roughness}});
}

void Engine::set_certainty(Certainty certainty) {
  const auto turn = implementation_->in_use.take();
  const std::size_t vertices =
      implementation_->graph.levels().empty() ? 0 : implementation_->graph.levels()[0].vertex_count();
  for (std::size_t i = 0; i < knowledge_names.size(); ++i) {
    const std::size_t count = certainty.stated[i].size();
    if (count == 0 || count == vertices) continue;
    throw InputError(std::string(knowledge_names[i]) + ": " + std::to_string(count) + " found, one for each of " +
                     std::to_string(vertices) + " vertices wanted");
  }
  implementation_->certainty = std::move(certainty);
}

const Certainty& Engine::certainty() const {
  return implementation_->certainty;
}

void Engine::set_edits(std::span<const Edit> edits) {
  const auto turn = implementation_->in_use.take();
  for (std::size_t i = 0; i < edits.size(); ++i) {
    try {
      check_edit(edits[i]);
    } catch (const InputError& error) {
      throw InputError("edit " + std::to_string(i) + ", " + error.what());
    }
  }
  if (implementation_->simulation) implementation_->simulation->set_edits(edits);
  implementation_->paths.set(edits);
  implementation_->edited = !edits.empty();
}

void Engine::set_cuts(std::span<const BodyCut> cuts) {
  const auto turn = implementation_->in_use.take();
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    try {
      check_cut(cuts[i]);
    } catch (const InputError& error) {
      throw InputError("cut " + std::to_string(i) + ", " + error.what());
    }
  }
  implementation_->paths.set(cuts);
  implementation_->cut_tools = path_tools(cuts);
}

void Engine::set_lights(std::vector<Light> lights) {
  const auto turn = implementation_->in_use.take();
  check_light_count(lights.size());
  for (const Light& light : lights) check_light(light);
  implementation_->images.load(lights);
  implementation_->lights = std::move(lights);
  implementation_->in_body.reset();
  implementation_->irradiance_given = false;
  implementation_->shadows_stale = implementation_->irradiance_stale = true;
}

void Engine::set_normal_map(const std::optional<NormalMap>& map) {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  check_options({.normal_map = map});
  if (map == self.facets_said) return;
  self.facets_said = map;
  self.facets_stale = true;
  self.irradiance_stale = self.irradiance_stale || !self.lights.empty();
}

void Engine::set_light_roughness(std::optional<float> alpha) {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  check_options({.transmission_roughness = alpha});
  if (alpha == self.light_roughness) return;
  self.light_roughness = alpha;
  self.set_surfaces(self.said_surfaces);
}

PresentScene Engine::present_scene() const {
  const auto& self = *implementation_;
  const bool at_rest = self.simulation ? self.simulation->at_rest() : !self.moved;
  const bool as_baked = at_rest && !self.edited && !self.facets_said;
  return {.file = self.source, .material = self.material, .lights = self.lights, .as_baked = as_baked};
}

void Engine::set_irradiance(std::uint32_t level, std::span<const glm::vec3> q,
                            const std::optional<glm::vec3>& direction) {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  self.levels().set_irradiance(level, q, direction);
  self.lean_nothing();
  if (!self.lights.empty()) self.shadows.update(self.mesh, {{}, self.bounds});
  self.lights.clear();
  self.in_body.reset();
  self.irradiance_given = true;
  self.irradiance_stale = self.irradiance_rough = false;
}

void Engine::update_irradiance() {
  const auto turn = implementation_->in_use.take();
  implementation_->update_irradiance(false);
}

void Engine::make_room(const SolveOptions& options) {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  if (options.method == Method::shortest_path) return static_cast<void>(solve(options));
  if (self.irradiance_behind(options)) self.update_irradiance(options.mean_rays);
  const bool gathered = gathers(options.method, options.source);
  self.interruptible([&] {
    self.levels().make_room(options, gathered);
    if (gathered) self.display_room();
  });
}

SolveReport Engine::solve(const SolveOptions& options, const std::function<void()>& check) {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  const bool by_path = options.method == Method::shortest_path;
  if (!self.cut_tools.empty() && !by_path) throw InputError("cuts: only the method shortest-path knows them");
  self.gather_passes.clear();
  self.deformation_passes.clear();
  self.light_passes.clear();
  if (!by_path && self.irradiance_behind(options)) self.check_irradiance();
  if (self.deformed && self.simulation) self.deformation_passes = self.simulation->deformation_passes();
  self.deformed = false;
  self.report.reset();
  self.again.reset();
  // What is seen of the sky is brought up to date by the solve.
  const auto light = [&](bool seen_anew) {
    if (self.irradiance_behind(options) || (seen_anew && self.sky_shines())) self.run_irradiance(options.mean_rays);
  };
  self.report = self.interruptible(
      [&] { return by_path ? self.solve_paths(options) : self.levels().solve(options, check, light); });
  if (self.report->correction && !options.warm && !self.lights.empty()) {
    self.interruptible([&] { self.state_light_error(options); });
  }
  if (self.report->correction && !options.warm && self.simulation->certifies(options)) {
    self.interruptible([&] { self.simulation->certify(options, *self.report, check); });
  }
  const bool of_one_text = !by_path && !self.body_roughness;
  if (self.body_roughness && !conserves(options.method)) self.report->index_warning = self.index_warning;
  if (of_one_text) self.report->size_warning = size_warning(self.material, self.of_text, self.simulation->chord());
  self.add_overlaps(*self.report);
  judge(*self.report, self.lights, self.lights_inside());
  if (self.ground) self.ground->relight();
  self.options = options;
  return *self.report;
}

SurfaceField Engine::surface_field() const {
  const auto turn = implementation_->in_use.take();
  const auto& self = *implementation_;
  if (self.report && self.report->path) {
    throw InputError("surface field: shortest-path has none; exitance_at tells what leaves at any point");
  }
  return self.levels().surface_field();
}

std::vector<glm::vec3> Engine::exitance_at(std::span<const glm::vec3> points) const {
  const auto turn = implementation_->in_use.take();
  const auto& self = *implementation_;
  if (!self.report || !self.report->path) throw InputError("exitance at points: solve with shortest-path first");
  return self.paths.exitance_at(points);
}

const PictureBuffers& Engine::draw(const View& view, const RenderOptions& options) {
  const auto turn = implementation_->in_use.take();
  check_options(options);
  check_view(view);
  if (const auto again = implementation_->again) solve(*again);
  const std::uint32_t count = frame_count(view, options);
  for (std::uint32_t index = 0; index < count; ++index) implementation_->add_frame(view, options, index);
  return implementation_->shown();
}

const PictureBuffers& Engine::draw_frame(const View& view, const RenderOptions& options, std::uint32_t index) {
  const auto turn = implementation_->in_use.take();
  check_options(options);
  implementation_->add_frame(view, options, index);
  return implementation_->shown();
}

Picture Engine::render(const View& view, const RenderOptions& options,
                       const std::function<void(const ConvergenceStep&)>& told) {
  const auto turn = implementation_->in_use.take();
  if (options.time_limit > 0 && options.converge == 0) {
    throw InputError("time_limit: found without converge, which it limits");
  }
  Picture picture = read_picture(implementation_->device, draw(view, options));
  picture.error = picture_error();
  if (const auto& shown = legend()) draw_legend(picture, *shown);
  if (options.converge == 0) return picture;
  if (!picture.error || implementation_->options.warm) {
    throw InputError(
        "converge: the error of this picture is not known; it is of a body with several levels, corrected at rest, "
        "with gathered radiance");
  }
  if (implementation_->options.certify > 0) throw InputError("converge: found with certify, which measures one solve");
  const ConvergingStart start{view, options, implementation_->options, *implementation_->report, *picture.error};
  const bool fits = picture.error->whole <= options.converge;
  try {
    picture = converged(*this, start, std::move(picture), told);
  } catch (...) {
    implementation_->again = start.solve;
    throw;
  }
  if (!fits) implementation_->again = start.solve;
  return picture;
}

std::optional<ErrorEstimate> Engine::picture_error(const ErrorEstimate& exitance) const {
  const auto turn = implementation_->in_use.take();
  return quadgraph::picture_error(implementation_->device, implementation_->shown(), exitance);
}

double Engine::medium_of_picture() const {
  const auto turn = implementation_->in_use.take();
  return quadgraph::medium_of_picture(implementation_->device, implementation_->shown());
}

std::optional<ErrorEstimate> Engine::picture_error() {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  if (!self.shown_error && self.report && self.report->error) {
    const device::Interruptible scope(self.device);
    self.shown_error = quadgraph::picture_error(self.device, self.shown(), *self.report->error);
  }
  return self.shown_error;
}

const std::optional<Legend>& Engine::legend() const {
  return implementation_->legend;
}

std::optional<Picked> Engine::pick(const View& view, float aspect, const glm::vec2& at) const {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  const Camera camera = place_camera(view, self.bounds, aspect);
  return quadgraph::pick(self.graph.display(), *self.bounds.outline, camera, at, self.cut_tools);
}

Leaving Engine::leaving(std::span<const std::uint32_t> face, std::span<const glm::vec3> direction) {
  const auto turn = implementation_->in_use.take();
  auto& self = *implementation_;
  if (!self.report) throw InputError("radiance: solve first");
  return self.interruptible([&] {
    const GatherField& field = self.gather(Gather::scaled);
    if (!self.probe) self.probe.emplace(self.device);
    return self.probe->run(self.levels().present_level(), field, face, direction);
  });
}

std::vector<PassStats> Engine::passes() const {
  const auto turn = implementation_->in_use.take();
  const auto& self = *implementation_;
  std::vector<PassStats> all;
  const bool by_path = self.report && self.report->path;
  const std::vector<PassStats> none;
  const auto& solved = by_path ? self.paths.passes() : self.simulation ? self.simulation->passes() : none;
  for (const auto* passes : {&self.deformation_passes, &self.irradiance_passes, &solved, &self.light_passes,
                             &self.gather_passes, &self.render_passes}) {
    all.insert(all.end(), passes->begin(), passes->end());
  }
  return all;
}

std::uint64_t Engine::device_bytes() const {
  return implementation_->device.allocated_bytes();
}

const std::map<std::string, std::uint64_t>& Engine::memory() const {
  return implementation_->device.allocated_by_purpose();
}

std::uint64_t Engine::allocation_count() const {
  return implementation_->device.allocation_count();
}

std::uint64_t Engine::peak_device_bytes() const {
  return implementation_->device.peak_allocated_bytes();
}

Metadata Engine::metadata() const {
  const auto turn = implementation_->in_use.take();
  const auto& self = *implementation_;
  if (!self.report) return {};
  return describe({self.source, self.material, self.lights, self.deformation, self.options, *self.report, self.view,
                   name_of(self.radiance), self.shown_error, self.device.info()});
}

}  // namespace quadgraph
