#include "engine/solve/simulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <map>

#include "engine/graph/error.h"
#include "engine/graph/exchange.h"
#include "engine/graph/moved_levels.h"
#include "engine/graph/sky.h"
#include "engine/solve/beams.h"
#include "engine/solve/coefficients.h"
#include "engine/solve/deformed_levels.h"
#include "engine/solve/gather_field.h"
#include "engine/solve/inter_reflection.h"
#include "engine/solve/level_upload.h"
#include "engine/solve/levels_solver.h"
#include "engine/solve/surface_results.h"
#include "shaders/surface_shared.h"

namespace quadgraph {
namespace {

// Passes that one solver has and the other has not, or more often.
double solver_ms(const std::vector<PassStats>& passes) {
  constexpr std::array names = {"residual",     "cg-multiply",     "cg-update",   "cg-direction",
                                "smoothing",    "coarse residual", "restriction", "coarse solve",
                                "prolongation", "surface change",  "transfer",    "eigenvalue bound"};
  double spent = 0;
  for (const PassStats& pass : passes) {
    if (std::find(names.begin(), names.end(), pass.name) != names.end()) spent += pass.time_ms;
  }
  return spent;
}

// Mean conduction of elements (stored_entries.h) from which deformed bodies are stored in single precision: below it
// packed entries change the exitance by less than 1e-3.
constexpr double packed_conduction = 50;

// As a number with two digits after the point.
std::string ratio_text(double ratio) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f", ratio);
  return text;
}

}  // namespace

struct Simulation::Implementation {
  vk::Context& context;
  MovedLevels shape;
  DeformedLevels deformed;
  std::optional<MovedLevels> present;  // of level 0 where the device has moved it, made at first use
  bool vertices_set = false;           // by set_vertices
  std::string spoilt;                  // SolveReport::deformed
  std::vector<PassStats> deformation_passes;
  std::vector<LevelBuffers> levels;
  BeamBuffers beams;
  std::vector<SourceWalk> walks;  // one per level
  Operators operators;
  Workspace work;
  SurfaceResults results;
  Coefficients coefficients;
  InterReflection exchange;
  std::optional<BodyTree> tree;       // of level 0, made at first use
  std::optional<GatherField> gather;  // the same
  bool gather_stale = true;
  std::vector<PassStats> passes;      // of the last solve
  bool scaled = false;                // the scale is that of the present q
  std::optional<OperatorKey> solved;  // by the last solve
  Source solved_source = Source::buried;
  std::vector<std::vector<SurfaceSample>> samples;      // per level
  std::map<Model, std::vector<Resolution>> resolution;  // per level, of the present material and shape
  double chord = 0;                                     // mm, of the finest level
  std::map<OperatorKey, SolverKind> quicker;            // where both have been tried, on the present material and shape

  Implementation(vk::Context& context_in, const QuadGraph& graph_in)
      : context(context_in),
        shape(graph_in),
        deformed(graph_in.levels()),
        levels(upload_levels(context_in, graph_in)),
        work(context_in, largest_dispatch()),
        results(context_in, levels[0]),
        coefficients(context_in, graph_in.levels()),
        exchange(graph_in) {
    for (std::uint32_t i = 0; i < levels.size(); ++i) walks.emplace_back(context, shape.levels()[i], i);
    sample();
    const gpu::Beam lambertian = beam_along(std::nullopt);
    light({&lambertian, 1});
  }

  void sample() {
    samples.clear();
    for (const Level& level : shape.levels()) samples.push_back(surface_samples(level));
    chord = mean_chord(shape.levels()[0]);
  }

  void light(std::span<const gpu::Beam> records) { replace_beams(context, records, beams, levels); }

  static std::vector<LevelBuffers> upload_levels(vk::Context& context, const QuadGraph& graph) {
    std::vector<LevelBuffers> levels;
    for (const Level& level : graph.levels()) {
      levels.push_back(upload_level(context, level, static_cast<std::uint32_t>(levels.size())));
    }
    const auto sky = sky_of_levels(graph.levels());
    for (std::size_t i = 0; i < levels.size(); ++i) levels[i].sky = vk::upload<float>(context, sky[i], "geometry/sky");
    return levels;
  }

  std::uint64_t largest_dispatch() const {
    std::uint64_t largest = 0;
    for (const LevelBuffers& level : levels) largest = std::max<std::uint64_t>(largest, level.node_count);
    return largest;
  }

  // Changed light: right-hand sides are stale.
  void unload() {
    scaled = false;
    for (SourceWalk& walk : walks) walk.invalidate();
    operators.unload();
  }

  // Changed coefficients: everything is.
  void disassemble() {
    quicker.clear();
    resolution.clear();
    operators.disassemble();
    unload();
  }

  void move(std::uint32_t number, std::span<const glm::vec3> positions) {
    shape.move(number, positions);
    const LevelBuffers& level = levels[number];
    vk::write_bytes(context, level.vertices, std::as_bytes(shape.levels()[number].vertices));
    if (level.nodes.size() > 0) {
      vk::write_bytes(context, level.nodes, std::as_bytes(shape.levels()[number].nodes));
    }
    operators.remeasure(number, shape.levels()[number]);
    samples[number] = surface_samples(shape.levels()[number]);
    if (number == 0) chord = mean_chord(shape.levels()[0]);
    exchange.moved(number);
    if (number == 0) gather.reset();
    vertices_set = true;
    forget_shape();
  }

  // What was known of the present shape.
  void forget_shape() {
    resolution.clear();
    quicker.clear();
    forget_place();
  }

  // What was known of where the body is.
  void forget_place() {
    present.reset();
    if (tree) tree->moved();
    solved.reset();
    unload();
  }

  bool deform(std::span<const Deformer> list, const RestBox& box, const std::function<void(Workspace&)>& also) {
    if (!vertices_set && std::equal(list.begin(), list.end(), deformed.list().begin(), deformed.list().end())) {
      return false;
    }
    work.recorder.clear();
    if (vertices_set || list.empty()) put_back();
    if (!list.empty()) move_on_device(list, box);
    if (also) also(work);
    work.recorder.submit();
    deformation_passes = work.recorder.passes();
    return true;
  }

  void put_back() {
    shape.put_back();
    deformed.put_back(context, levels);
    operators.put_back();
    exchange.put_back(context, levels);
    if (vertices_set) gather.reset();
    vertices_set = false;
    spoilt.clear();
    sample();
    forget_shape();
  }

  void move_on_device(std::span<const Deformer> list, const RestBox& box) {
    const bool same = deformed.same_shape(list);
    deformed.record(work, list, box, levels);
    if (same) {
      exchange.turned();
      return forget_place();
    }
    work.recorder.submit();
    for (std::uint32_t i = 0; i < levels.size(); ++i) {
      ShapeState state = deformed.state(i);
      levels[i].inverted = state.inverted > 0;
      operators.remeasure(i, state.conduction > packed_conduction);
      exchange.moved(i);
      samples[i] = std::move(state.samples);
      if (i > 0) continue;
      chord = state.chord;
      spoilt = deformed_text(state);
    }
    forget_shape();
  }

  const Level& present_level() {
    if (deformed.list().empty()) return shape.levels()[0];
    if (!present) {
      present.emplace(shape);
      present->place(0, vk::download<glm::vec3>(context, levels[0].vertices));
    }
    return present->levels()[0];
  }

  SolveReport solve(const SolveOptions& options) {
    check_options(options);
    solved.reset();
    work.recorder.clear();
    const OperatorKey key = key_of(options);
    make_room(key, options);
    exchange.refresh(work, shape.levels(), levels, options.exchange_rows);
    SolveReport report =
        options.solver == SolverKind::automatic ? solve_quickly(key, options) : run(key, options, options.solver);
    warn(options.source, report);
    report.deformed = spoilt;
    passes = work.recorder.passes();
    gather_stale = true;
    solved = key;
    solved_source = options.source;
    return report;
  }

  OperatorKey key_of(const SolveOptions& options) {
    coefficients.check();
    return {options.method, coefficients.resolve(work, options.model, options.method, options.source, levels)};
  }

  void make_room(const OperatorKey& key, const SolveOptions& options) {
    coefficients.make_room(key.method, levels);
    for (std::uint32_t i = 0; i < levels.size() && key.method != Method::fem; ++i) {
      const bool there = levels[i].nodes.size() > 0;
      upload_graph(context, shape.levels()[i], i, levels[i]);
      if (!there && !deformed.list().empty()) deformed.record_nodes(work, i, levels[i]);
    }
    const bool two_steps = options.smoothing == 2 || (options.smoothing == 0 && options.solver == SolverKind::vcycle);
    operators.create(context, shape.levels(), key, coefficients.even(), two_steps);
    const std::optional<std::uint32_t> bounced = bounces_wanted(options) ? exchange.level() : std::nullopt;
    if (bounced) exchange.make_room(work, levels);
    for (std::uint32_t i = 0; i < levels.size() && options.source == Source::buried; ++i) {
      walks[i].make_room(context, levels[i], beams, key.method, bounced && i <= *bounced);
    }
  }

  GatherField& gather_room() {
    if (!tree) tree.emplace(context, shape.levels()[0], "gather");
    if (!gather) gather.emplace(context, shape.levels()[0], *tree);
    return *gather;
  }

  std::vector<gpu::Optical> optical_at(std::uint32_t level) { return coefficients.at(level, samples[level]); }

  const std::vector<Resolution>& resolution_with(Model model) {
    std::vector<Resolution>& found = resolution[model];
    for (auto i = static_cast<std::uint32_t>(found.size()); i < levels.size(); ++i) {
      found.push_back(resolution_of(samples[i], optical_at(i), static_cast<double>(coefficients.eta()), model));
    }
    return found;
  }

  void warn(Source source, SolveReport& report) {
    if (report.method == Method::fem) {
      report.mesh_warning = mesh_warning(resolution_with(report.model)[report.finest]);
    }
    report.model_warning =
        model_warning(optical_at(0), static_cast<double>(coefficients.eta()), chord, source, report.model);
  }

  SolveReport run(const OperatorKey& key, const SolveOptions& options, SolverKind solver) {
    const bool known = key.method == Method::fem && options.source == Source::buried;
    const SolveParts parts{
        work,         levels,
        beams,        walks,
        operators,    results,
        coefficients, exchange,
        scaled,       known ? std::span<const Resolution>(resolution_with(key.model)) : std::span<const Resolution>{}};
    return LevelsSolver(parts, key, options, solver).run();
  }

  // With the solver that took less time when both were tried, which the first solve from nothing does.
  SolveReport solve_quickly(const OperatorKey& key, const SolveOptions& options) {
    if (!Multigrid::possible(operators, key)) return run(key, options, SolverKind::dpcg);
    const auto found = quicker.find(key);
    if (found != quicker.end()) return run(key, options, found->second);
    if (options.warm || options.cycles > 0 || options.error > 0) return run(key, options, SolverKind::fmg_pcg);
    const SolveReport cycles = run(key, options, SolverKind::fmg_pcg);
    const double cycles_ms = solver_ms(work.recorder.passes());
    if (!cycles.replaced.empty()) {
      quicker[key] = SolverKind::dpcg;
      return cycles;
    }
    SolveReport report = run(key, options, SolverKind::dpcg);
    const double dpcg_ms = solver_ms(work.recorder.passes()) - cycles_ms;
    quicker[key] = dpcg_ms < cycles_ms ? SolverKind::dpcg : SolverKind::fmg_pcg;
    report.replaced = "auto: both tried, " + std::string(name_of(quicker[key])) + " from now on: dpcg took " +
                      ratio_text(dpcg_ms / cycles_ms) + " of the time of fmg-pcg";
    return report;
  }

  const OperatorKey& solved_key() const {
    if (!solved) throw InputError("no solution: solve has not succeeded yet");
    return *solved;
  }

  const GatherField& gathered(std::vector<PassStats>& gather_passes) {
    gather_passes.clear();
    gather_room();
    if (!gather_stale) return *gather;
    work.recorder.clear();
    gather->record(work, {levels[0], operators.at(*solved, 0), beams, results.vertex_exitance(),
                          walks[0].body(levels[0], coefficients.eta(), coefficients.even()), *tree});
    work.recorder.submit();
    gather_passes = work.recorder.passes();
    gather_stale = false;
    return *gather;
  }

  std::vector<glm::vec3> exitance_on(std::uint32_t number) {
    OperatorBuffers& op = operators.at(solved_key(), number);
    if (number >= levels.size() || !op.solved) {
      throw InputError("level " + std::to_string(number) + " of exitance: the last solve did not go over it");
    }
    const LevelBuffers& level = levels[number];
    const vk::Buffer phi(context, level.face_count * sizeof(glm::vec3), vk::Place::read, "results/phi of a level");
    const vk::Buffer exitance(context, level.face_count * sizeof(glm::vec3), vk::Place::read,
                              "results/exitance of a level");
    const vk::Buffer clip(context, sizeof(gpu::Clip), vk::Place::device, "results/clip of a level");
    const Boundary boundary =
        boundary_of(solved->method, solved_source, solved->model, static_cast<double>(coefficients.eta()));
    record_exitance(work, {level, op, solved->method, boundary, nullptr}, phi, exitance, clip);
    work.recorder.submit();
    return vk::download<glm::vec3>(context, exitance);
  }

  glm::vec3 scale() const { return vk::download<gpu::Scale>(context, work.scale)[0].scale; }

  // W/mm^2 per face.
  std::vector<glm::vec3> unscattered(std::span<const float> area) const {
    std::vector<glm::vec3> field(area.size(), glm::vec3(0));
    if (solved_source == Source::diffuse) return field;
    const std::vector<glm::dvec3> power = walks[0].unscattered_power(context, glm::dvec3(scale()));
    for (std::size_t f = 0; f < area.size(); ++f) {
      if (area[f] > 0) field[f] = glm::vec3(power[f] / static_cast<double>(area[f]));
    }
    return field;
  }
};

Simulation::Simulation(vk::Context& context, const QuadGraph& graph)
    : implementation_(std::make_unique<Implementation>(context, graph)) {}

Simulation::~Simulation() = default;

std::uint32_t Simulation::level_count() const {
  return static_cast<std::uint32_t>(implementation_->levels.size());
}

const LevelBuffers& Simulation::level(std::uint32_t level) const {
  return implementation_->levels.at(level);
}

std::optional<SeenRows> Simulation::seen() {
  return implementation_->exchange.seen(implementation_->context);
}

void Simulation::set_material(const gpu::Material& material) {
  implementation_->coefficients.set(material);
  implementation_->disassemble();
}

void Simulation::set_optical(std::uint32_t level, std::span<const gpu::Optical> optical, float eta) {
  if (level >= level_count()) {
    throw InputError("level " + std::to_string(level) + " of optical: there are " + std::to_string(level_count()));
  }
  implementation_->coefficients.set(level, optical, eta, implementation_->samples[level]);
  implementation_->disassemble();
}

void Simulation::set_edits(std::span<const Edit> edits) {
  implementation_->coefficients.set(edits);
  implementation_->disassemble();
}

float Simulation::eta() const {
  implementation_->coefficients.check();
  return implementation_->coefficients.eta();
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
  write_irradiance(implementation_->context, q, level, implementation_->levels[level]);
  irradiance_changed();
}

void Simulation::irradiance_changed() {
  implementation_->unload();
}

void Simulation::set_vertices(std::uint32_t level, std::span<const glm::vec3> positions) {
  implementation_->move(level, positions);
}

bool Simulation::set_deformation(std::span<const Deformer> list, const RestBox& rest,
                                 const std::function<void(Workspace&)>& also) {
  return implementation_->deform(list, rest, also);
}

const std::vector<PassStats>& Simulation::deformation_passes() const {
  return implementation_->deformation_passes;
}

const Level& Simulation::present_level() const {
  return implementation_->present_level();
}

void Simulation::make_room(const SolveOptions& options, bool gather) {
  implementation_->make_room(implementation_->key_of(options), options);
  implementation_->work.recorder.submit();
  if (gather) implementation_->gather_room();
}

SolveReport Simulation::solve(const SolveOptions& options) {
  return implementation_->solve(options);
}

const std::vector<PassStats>& Simulation::passes() const {
  return implementation_->passes;
}

SurfaceField Simulation::surface_field() const {
  const Implementation& self = *implementation_;
  self.solved_key();
  const Level& level = implementation_->present_level();
  SurfaceField field;
  field.q = vk::download<glm::vec3>(self.context, self.levels[0].q);
  field.phi = vk::download<glm::vec3>(self.context, self.results.phi());
  field.exitance = vk::download<glm::vec3>(self.context, self.results.exitance());
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::uvec3& face = level.faces[f];
    const glm::dvec3 p(level.vertices[face.x]);
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(level.vertices[face.y]) - p, glm::dvec3(level.vertices[face.z]) - p);
    field.position.push_back(level.nodes[level.tet_count() + f]);
    field.normal.push_back(glm::vec3(normal / std::max(glm::length(normal), 1e-300)));
    field.area.push_back(static_cast<float>(0.5 * glm::length(normal)));
  }
  field.unscattered = self.unscattered(field.area);
  return field;
}

std::vector<glm::vec3> Simulation::phi() const {
  const Implementation& self = *implementation_;
  const OperatorBuffers& rows = implementation_->operators.at(self.solved_key(), 0);
  const std::size_t moments = rows.model == Model::sp3 ? 2 : 1;
  const auto x = vk::download<glm::vec3>(self.context, rows.x);
  std::vector<glm::vec3> phi(rows.count, glm::vec3(1));
  if (rows.to_phi.size() > 0) phi = vk::download<glm::vec3>(self.context, rows.to_phi);
  const glm::vec3 scale = self.scale();
  for (std::size_t i = 0; i < phi.size(); ++i) phi[i] *= x[moments * i] * scale;
  return phi;
}

std::vector<glm::vec3> Simulation::exitance_on(std::uint32_t level) {
  return implementation_->exitance_on(level);
}

const vk::Buffer& Simulation::vertex_exitance() const {
  return implementation_->results.vertex_exitance();
}

const vk::Buffer& Simulation::vertex_unscattered() const {
  return implementation_->results.vertex_unscattered();
}

bool Simulation::can_gather() const {
  return implementation_->solved_key().method == Method::fem && implementation_->solved_source == Source::buried;
}

const GatherField& Simulation::gather(std::vector<PassStats>& passes) {
  if (!can_gather()) {
    throw InputError(
        "radiance: gathering needs --method fem and --source buried; 'lambertian' is there for every method");
  }
  return implementation_->gathered(passes);
}

}  // namespace quadgraph
