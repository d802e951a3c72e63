#include "engine/solve/simulation.h"

#include <cmath>

#include "engine/solve/importance.h"
#include "engine/solve/simulation_implementation.h"

namespace quadgraph {
namespace {

Certifier& made(std::optional<Certifier>& certifier, device::Device& device, const BodyShape& shape) {
  return certifier ? *certifier : certifier.emplace(device, shape.levels()[0]);
}

}  // namespace

Simulation::Simulation(device::Device& device, const QuadGraph& graph)
    : implementation_(std::make_unique<Implementation>(device, graph)) {}

Simulation::~Simulation() = default;

std::uint32_t Simulation::level_count() const {
  return static_cast<std::uint32_t>(implementation_->levels.size());
}

const LevelBuffers& Simulation::level(std::uint32_t level) const {
  return implementation_->levels.at(level);
}

double Simulation::chord() const {
  return implementation_->shape.chord();
}

std::optional<SeenRows> Simulation::seen() {
  return implementation_->exchange.seen(implementation_->device);
}

void Simulation::set_material(const gpu::Material& material) {
  implementation_->coefficients.set(material);
  implementation_->disassemble();
  set_etendue({});
}

void Simulation::set_angles(const ScatteringAngles& angles) {
  const bool same = implementation_->coefficients.angles() == angles;
  implementation_->coefficients.set(angles);
  if (!same) implementation_->disassemble();
}

void Simulation::set_optical(std::uint32_t level, std::span<const gpu::Optical> optical, float eta,
                             std::span<const gpu::Optical> elsewhere) {
  set_optical(level, optical, std::span(&eta, 1), elsewhere);
}

void Simulation::set_optical(std::uint32_t level, std::span<const gpu::Optical> optical, std::span<const float> eta,
                             std::span<const gpu::Optical> elsewhere) {
  if (level >= level_count()) {
    throw InputError("level " + std::to_string(level) + " of optical: there are " + std::to_string(level_count()));
  }
  implementation_->coefficients.set(level, optical, eta, implementation_->shape.samples(level), elsewhere);
  implementation_->disassemble();
}

void Simulation::set_etendue(std::span<const float> by_body) {
  Implementation& self = *implementation_;
  if (!self.etendue.set(self.device, self.shape.levels(), by_body, self.levels)) return;
  self.operators.measure_anew();
  if (self.correction) self.correction->forget();
}

void Simulation::set_finishes(std::span<const Finish> finishes) {
  if (implementation_->refractions.set_finishes(finishes)) implementation_->disassemble();
}

void Simulation::set_edits(std::span<const Edit> edits) {
  implementation_->coefficients.set(edits);
  implementation_->disassemble();
}

std::span<const OpticalSurface> Simulation::surfaces() const {
  implementation_->coefficients.check();
  return implementation_->refractions.surfaces();
}

std::vector<float> Simulation::eta() const {
  implementation_->coefficients.check();
  return implementation_->refractions.eta();
}

void Simulation::set_beams(std::span<const gpu::Beam> beams) {
  implementation_->light(beams);
  irradiance_changed();
}

void Simulation::set_irradiance(std::uint32_t level, std::span<const glm::vec3> q,
                                const std::optional<glm::vec3>& direction) {
  if (level >= level_count()) {
    throw InputError("level " + std::to_string(level) + " of irradiance: there are " + std::to_string(level_count()));
  }
  const gpu::Beam beam = beam_along(direction);
  implementation_->light({&beam, 1});
  write_irradiance(implementation_->device, q, level, implementation_->levels[level]);
  irradiance_changed();
}

void Simulation::irradiance_changed() {
  implementation_->unload();
}

void Simulation::set_leaning(std::uint32_t level, std::span<const glm::vec2> leaning) {
  Implementation& self = *implementation_;
  lean_faces(self.device, self.shape.levels().at(level), level, self.refractions, leaning, self.levels.at(level));
  irradiance_changed();
}

void Simulation::set_vertices(std::uint32_t level, std::span<const glm::vec3> positions) {
  implementation_->move(level, positions);
}

bool Simulation::set_deformation(std::span<const Deformer> list, const RestBox& rest,
                                 const std::function<void(Workspace&)>& also) {
  return implementation_->deform(list, rest, also);
}

bool Simulation::at_rest() const {
  return implementation_->shape.is({});
}

const std::vector<PassStats>& Simulation::deformation_passes() const {
  return implementation_->deformation_passes;
}

const Level& Simulation::present_level() const {
  return implementation_->shape.present(implementation_->device, implementation_->levels[0]);
}

void Simulation::make_room(const SolveOptions& options, bool gather) {
  implementation_->make_room(implementation_->key_of(options), options);
  if (certifies(options)) made(implementation_->certifier, implementation_->device, implementation_->shape);
  implementation_->work.recorder.submit();
  if (gather) implementation_->gather_room();
}

SolveReport Simulation::solve(const SolveOptions& options, const std::function<void()>& check,
                              const std::function<void(bool)>& light) {
  implementation_->certified = false;
  implementation_->elsewhere = {};
  SolveReport report = implementation_->solve(options, check, light);
  const KnownAngles by_sweeps = options.warm ? KnownAngles::swept : KnownAngles::measured;
  const KnownAngles known = report.correction ? by_sweeps : KnownAngles::reduced;
  report.phase_warning = quadgraph::phase_warning(implementation_->coefficients.angles(), known);
  if (!options.warm && report.correction) state_medium_error(options, report);
  if (report.correction) implementation_->carried->keep_error(report);
  return report;
}

LightRoom Simulation::light_room(const SolveOptions& options) {
  Implementation& self = *implementation_;
  return {self.beams.on_device, self.light_error->difference(), self.tree->ref(), entering_rays(options.mean_rays),
          1 / std::sqrt(static_cast<float>(std::max(options.mean_of, 1u)))};
}

void Simulation::state_light_error(const SolveOptions& options, SolveReport& report) {
  Implementation& self = *implementation_;
  const double k11 = self.correction_boundaries().least_k11();
  const glm::dvec3 share = share_of_surface_light(report.energy, k11, self.optical_at(0));
  perturb(options, report, [&](const PerturbedSolution& solution) {
    add_light_error(report, self.light_error->estimate(*self.perturbation, solution, share));
  });
}

void Simulation::state_medium_error(const SolveOptions& options, SolveReport& report) {
  Implementation& self = *implementation_;
  const std::vector<gpu::Optical>& there = self.coefficients.elsewhere();
  if (there.empty()) return;
  const auto here = device::download<gpu::Optical>(self.device, self.levels[0].optical);
  const auto fluence = device::download<glm::vec3>(self.device, self.correction->fluence());
  const Level& level = present_level();
  const std::vector<glm::vec3> load =
      medium_load(level, here, std::span(there).first(level.tet_count()), fluence, [&] { self.device.heed(); });
  self.elsewhere = device::upload<gpu::Optical>(self.device, there, "material/elsewhere");
  perturb(options, report, [&](const PerturbedSolution& solution) {
    add_medium_error(report, medium_error(*self.perturbation, solution, load));
  });
}

bool Simulation::certifies(const SolveOptions& options) const {
  return options.certify > 0 ||
         (corrects(options) && !options.warm && implementation_->coefficients.angles().g != glm::vec3(0));
}

void Simulation::certify(const SolveOptions& options, SolveReport& report, const std::function<void()>& check,
                         std::span<const glm::vec3> importance) {
  Implementation& self = *implementation_;
  std::vector<glm::vec3> own;
  if (options.certify > 0 && options.guided_walks && importance.empty()) {
    self.with_solution(self.correction_boundaries(), [&](const PerturbedSolution& solution) {
      own = importance_of(*self.perturbation, solution, present_level());
    });
    importance = own;
  }
  report.certificate = made(self.certifier, self.device, self.shape)
                           .run({.work = self.work,
                                 .level = self.levels[0],
                                 .beams = self.beams,
                                 .field = self.correction->field(),
                                 .surface = surface_field(),
                                 .scale = device::download<gpu::Scale>(self.device, self.work.scale)[0],
                                 .entered = report.energy.entered,
                                 .g = self.coefficients.angles().g,
                                 .importance = importance},
                                options.certify, options.sweep_seed, check);
  self.certified = true;
  if (self.coefficients.angles().g != glm::vec3(0)) add_phase_error(report);
  state_disagreement(report);
  state_anew(report, options.error);
  self.passes = self.work.recorder.passes();
}

void Simulation::perturb(const SolveOptions& options, SolveReport& report,
                         const std::function<void(const PerturbedSolution&)>& state) {
  Implementation& self = *implementation_;
  self.with_solution(self.correction_boundaries(), state);
  state_anew(report, options.error);
  self.passes = self.work.recorder.passes();
}

void Simulation::start_over() {
  implementation_->start_over();
}

const std::vector<PassStats>& Simulation::passes() const {
  return implementation_->passes;
}

SurfaceField Simulation::surface_field() const {
  const Implementation& self = *implementation_;
  self.solved_key();
  SurfaceField field = surface_of(implementation_->shape.present(self.device, self.levels[0]));
  field.q = device::download<glm::vec3>(self.device, self.levels[0].q);
  field.phi = device::download<glm::vec3>(self.device, self.results.phi());
  field.exitance = device::download<glm::vec3>(self.device, self.results.exitance());
  field.unscattered = self.unscattered(field.area);
  return field;
}

WalkedExitance Simulation::walked_exitance() const {
  const Implementation& self = *implementation_;
  if (!self.certified) throw InputError("walked exitance: no walks have certified the last solve; solve with certify");
  return self.certifier->exitance(self.device);
}

std::vector<glm::vec3> Simulation::phi() const {
  std::vector<glm::vec3> found = implementation_->basic_phi();
  if (!implementation_->etendue.bends()) return found;
  const std::vector<float> counts =
      implementation_->etendue.at_carriers(present_level(), implementation_->solved->method);
  for (std::size_t i = 0; i < found.size(); ++i) found[i] *= counts[i];
  return found;
}

std::vector<glm::vec3> Simulation::basic_phi() const {
  return implementation_->basic_phi();
}

const Etendue& Simulation::etendue() const {
  return implementation_->etendue;
}

std::vector<glm::vec3> Simulation::exitance_on(std::uint32_t level) {
  return implementation_->exitance_on(level);
}

std::vector<LevelBeam> Simulation::light_on(std::uint32_t level) {
  const LevelBuffers& buffers = implementation_->solved_level(level);
  return level_light(implementation_->device, implementation_->beams, buffers);
}

const device::Buffer& Simulation::exitance() const {
  return implementation_->results.exitance();
}

const device::Buffer& Simulation::vertex_exitance() const {
  return implementation_->results.vertex_exitance();
}

const device::Buffer& Simulation::vertex_unscattered() const {
  return implementation_->results.vertex_unscattered();
}

const device::Buffer* Simulation::elsewhere() const {
  const Implementation& self = *implementation_;
  return self.corrected && self.elsewhere.size() > 0 ? &self.elsewhere : nullptr;
}

const device::Buffer* Simulation::surface_share() const {
  Implementation& self = *implementation_;
  return self.corrected ? &self.operators.at(correction_key, 0).surface_share : nullptr;
}

bool Simulation::can_gather() const {
  return gathers(implementation_->solved_key().method, implementation_->solved_source);
}

const GatherField& Simulation::gather(Gather what, std::vector<PassStats>& passes) {
  if (what == Gather::scaled && !can_gather()) {
    throw InputError(
        "radiance: gathering needs --method fem, polygrid or polygrid-divergence and --source buried; 'lambertian' and "
        "'single' are there for every method");
  }
  return implementation_->gathered(what, passes);
}

}  // namespace quadgraph
