#include "engine/solve/simulation.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <glm/geometric.hpp>
#include <map>

#include "engine/graph/error.h"
#include "engine/graph/exchange.h"
#include "engine/graph/moved_levels.h"
#include "engine/graph/sky.h"
#include "engine/solve/assembly.h"
#include "engine/solve/beams.h"
#include "engine/solve/coefficients.h"
#include "engine/solve/gather_field.h"
#include "engine/solve/inter_reflection.h"
#include "engine/solve/level_solver.h"
#include "engine/solve/level_upload.h"
#include "engine/solve/surface_results.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3);

void check_options(const SolveOptions& options) {
  if (!(options.tolerance > 0) || !(options.tolerance < 1)) {
    throw InputError("tolerance: " + std::to_string(options.tolerance) + ", a number between 0 and 1 is wanted");
  }
}

// What an operator is made for.
struct OperatorKey {
  Method method;
  Model model;

  auto operator<=>(const OperatorKey&) const = default;
};

bool same(const Boundary& a, const Boundary& b) {
  return a.k11 == b.k11 && a.k12 == b.k12 && a.k22 == b.k22;
}

}  // namespace

struct Simulation::Implementation {
  // What one method and model need on one level.
  struct OperatorLevel {
    std::optional<OperatorBuffers> op;
    std::optional<TransferBuffers> transfer;
  };

  vk::Context& context;
  MovedLevels shape;
  std::vector<LevelBuffers> levels;
  BeamBuffers beams;
  std::vector<SourceWalk> walks;                                // one per level
  std::map<OperatorKey, std::vector<OperatorLevel>> operators;  // those solved so far
  Workspace work;
  SurfaceResults results;
  Coefficients coefficients;
  InterReflection exchange;
  std::optional<GatherField> gather;  // made at first use
  bool gather_stale = true;
  std::vector<PassStats> passes;      // of the last solve
  bool scaled = false;                // the scale is that of the present q
  std::optional<OperatorKey> solved;  // by the last solve
  Source solved_source = Source::buried;

  Implementation(vk::Context& context_in, const QuadGraph& graph_in)
      : context(context_in),
        shape(graph_in),
        levels(upload_levels(context_in, graph_in)),
        work(context_in, largest_dispatch()),
        results(context_in, levels[0]),
        coefficients(levels.size()),
        exchange(graph_in) {
    for (std::uint32_t i = 0; i < levels.size(); ++i) walks.emplace_back(context, shape.levels()[i], i);
    const gpu::BeamRecord lambertian = beam_along(std::nullopt);
    light({&lambertian, 1});
  }

  void light(std::span<const gpu::BeamRecord> records) { replace_beams(context, records, beams, levels); }

  static std::vector<LevelBuffers> upload_levels(vk::Context& context, const QuadGraph& graph) {
    std::vector<LevelBuffers> levels;
    for (const Level& level : graph.levels()) {
      levels.push_back(upload_level(context, level, static_cast<std::uint32_t>(levels.size())));
    }
    const auto sky = sky_of_levels(graph.levels());
    for (std::size_t i = 0; i < levels.size(); ++i) levels[i].sky = vk::upload<float>(context, sky[i], "sky");
    return levels;
  }

  std::uint64_t largest_dispatch() const {
    std::uint64_t largest = 0;
    for (const LevelBuffers& level : levels) largest = std::max<std::uint64_t>(largest, level.node_count);
    return largest;
  }

  OperatorBuffers& op(const OperatorKey& key, std::uint32_t level) { return *operators.at(key)[level].op; }

  // Changed light: right-hand sides are stale.
  void unload() {
    scaled = false;
    for (SourceWalk& walk : walks) walk.invalidate();
    for_each_operator([](OperatorBuffers& op) { op.loaded.reset(); });
  }

  // Changed coefficients: everything is.
  void disassemble() {
    for_each_operator([](OperatorBuffers& op) { op.assembled.reset(); });
    unload();
  }

  void move(std::uint32_t number, std::span<const glm::vec3> positions) {
    shape.move(number, positions);
    LevelBuffers& level = levels[number];
    if (level.rest.size() == 0) {
      level.rest = std::move(level.nodes);
      level.nodes = {context, level.rest.size(), vk::Place::device, "moved nodes"};
    }
    vk::write_bytes(context, level.vertices, std::as_bytes(shape.levels()[number].vertices));
    vk::write_bytes(context, level.nodes, std::as_bytes(shape.levels()[number].nodes));
    for (auto& [key, of_key] : operators) {
      if (!of_key[number].op) continue;
      of_key[number].op->measured = false;
      of_key[number].op->assembled.reset();
    }
    exchange.moved(number);
    if (number == 0) gather.reset();
    solved.reset();
    unload();
  }

  template <typename Function>
  void for_each_operator(const Function& function) {
    for (auto& [key, of_key] : operators) {
      for (OperatorLevel& level : of_key) {
        if (level.op) function(*level.op);
      }
    }
  }

  void create_structures(const OperatorKey& key) {
    auto& of_key = operators[key];
    of_key.resize(levels.size());
    const std::vector<Level>& source = shape.levels();
    for (std::uint32_t i = 0; i < levels.size(); ++i) {
      if (of_key[i].op) continue;
      of_key[i].op.emplace(context, source[i], i, key.method, key.model);
      if (i + 1 < levels.size()) of_key[i].transfer.emplace(context, source[i], source[i + 1], i, key.method);
    }
  }

  void record_load(std::uint32_t level, const OperatorKey& key, const Boundary& boundary, Source source,
                   OperatorBuffers& rows) {
    if (rows.loaded == source) return;
    if (source == Source::buried) {
      walks[level].record(work, levels[level], beams, key.method, coefficients.eta(), coefficients.even());
      walks[level].record_right_hand_side(work, levels[level], key.method, rows);
    } else {
      record_diffuse_load(work, levels[level], key.method, boundary, rows);
    }
    rows.loaded = source;
  }

  void record_setup(const OperatorKey& key, const Boundary& boundary, const SolveOptions& options) {
    coefficients.record(work, levels);
    if (!scaled) record_scale(work, levels[0]);
    scaled = true;
    for (std::uint32_t i = 0; i < levels.size(); ++i) {
      OperatorBuffers& rows = op(key, i);
      if (!rows.assembled || !same(*rows.assembled, boundary)) {
        record_assembly(work, levels[i], key.method, boundary, coefficients.even(), rows);
        rows.assembled = boundary;
        rows.damped = false;
        rows.loaded.reset();
      }
      if (!rows.damped && options.solver == SolverKind::cascade) {
        record_damping(work, key.method, rows);
        rows.damped = true;
      }
      record_load(i, key, boundary, options.source, rows);
    }
  }

  void record_transfer(const OperatorKey& key, std::uint32_t level) {
    const OperatorBuffers& coarse = op(key, level + 1);
    const OperatorBuffers& fine = op(key, level);
    for (const auto& part : operators.at(key)[level].transfer->parts) {
      const gpu::TransferPush push{.index = part.index.address(),
                                   .weight = part.weight.address(),
                                   .coarse_x = coarse.x.address(),
                                   .coarse_to_phi = coarse.to_phi.address(),
                                   .to_phi = fine.to_phi.address(),
                                   .x = fine.x.address(),
                                   .state = fine.state.address(),
                                   .width = part.width,
                                   .first = part.first,
                                   .coarse_first = part.coarse_first,
                                   .count = part.count};
      work.recorder.dispatch(work.passes.transfer.of(key.model), push, part.count, "transfer",
                             part.count * (part.width * (8 + vec3_bytes + fine.field_bytes()) + 2 * vec3_bytes));
    }
  }

  Solved solved_level(const OperatorKey& key, const Boundary& boundary, Source source, std::uint32_t level) {
    return {levels[level], op(key, level), key.method, boundary, source == Source::buried ? &walks[level] : nullptr};
  }

  // b with the light that enters again.
  void record_load_again(const OperatorKey& key, std::uint32_t level) {
    walks[level].record_again(work, levels[level], beams, key.method, coefficients.eta(), coefficients.even());
    walks[level].record_right_hand_side(work, levels[level], key.method, op(key, level));
    op(key, level).loaded.reset();
  }

  void solve_levels(const OperatorKey& key, const Boundary& boundary, const SolveOptions& options,
                    SolveReport& report) {
    for (auto i = static_cast<std::uint32_t>(levels.size()); i-- > 0;) {
      OperatorBuffers& rows = op(key, i);
      if (report.inter_reflection && i <= exchange.level()) {
        exchange.record_beam(work, levels, i, coefficients.eta());
        if (exchange.any()) record_load_again(key, i);
      }
      if (i + 1 == levels.size()) {
        work.recorder.fill(rows.x, 0);
      } else {
        record_transfer(key, i);
        if (i == 0) results.record_coarse(work, solved_level(key, boundary, options.source, i));
      }
      report.levels.push_back(solve_level(work, rows, i, options));
      if (!report.inter_reflection || i != exchange.level()) continue;
      if (i == 0 && !exchange.any()) estimate_error(key, boundary, options.source, report);
      bounce(key, boundary, options, report);
    }
    const bool finest_alone = report.inter_reflection && exchange.level() == 0u;
    results.record(work, solved_level(key, boundary, options.source, 0));
    work.recorder.submit();
    if (levels.size() > 1 && !finest_alone) report.error = results.error();
  }

  // Of the finest level before it has bounces that the coarser ones do not have.
  void estimate_error(const OperatorKey& key, const Boundary& boundary, Source source, SolveReport& report) {
    if (levels.size() == 1) return;
    results.record(work, solved_level(key, boundary, source, 0));
    work.recorder.submit();
    report.error = results.error();
  }

  // On the level with the exchange, from the solution it has.
  void bounce(const OperatorKey& key, const Boundary& boundary, const SolveOptions& options, SolveReport& report) {
    const std::uint32_t level = *exchange.level();
    const Solved here = solved_level(key, boundary, options.source, level);
    LevelReport& total = report.levels.back();
    for (std::uint32_t left = options.bounces > 0 ? options.bounces : max_bounces; left > 0; --left) {
      const glm::dvec3 before = exchange.power();
      exchange.record_bounce(work, here, coefficients.eta());
      record_load_again(key, level);
      const std::uint32_t iterations = total.iterations;
      total = solve_level(work, op(key, level), level, options);
      total.iterations += iterations;
      report.bounces.push_back(exchange.power() - before);
      if (options.bounces == 0 && exchange.converged(options.tolerance / 10)) return;
    }
  }

  SolveReport solve(const SolveOptions& options) {
    check_options(options);
    coefficients.check();
    solved.reset();
    work.recorder.clear();
    const OperatorKey key{options.method, coefficients.resolve(options.model, options.method, options.source)};
    const Boundary boundary = boundary_of(key.method, options.source, key.model, coefficients.eta());
    create_structures(key);
    exchange.refresh(work, shape.levels(), levels, options.exchange_rows);
    for (SourceWalk& walk : walks) walk.forget_again();
    record_setup(key, boundary, options);
    SolveReport report;
    report.method = key.method;
    report.solver = options.solver;
    report.source = options.source;
    report.model = key.model;
    report.exchange_age = exchange.age();
    report.inter_reflection = bounces_wanted(options) && exchange.baked();
    if (!report.inter_reflection || options.bounces == 0) exchange.record_none(work, levels);
    solve_levels(key, boundary, options, report);
    passes = work.recorder.passes();
    report.energy = energy_of(options.source);
    if (report.inter_reflection) report.energy.re_entered = exchange.power();
    report.clipped = results.clipped();
    gather_stale = true;
    solved = key;
    solved_source = options.source;
    return report;
  }

  Energy energy_of(Source source) const {
    Energy energy = results.energy();
    if (source == Source::buried) {
      const WalkPower power = walks[0].power();
      energy.absorbed += power.absorbed;
      energy.unscattered_out = power.unscattered;
    }
    return energy;
  }

  const OperatorKey& solved_key() const {
    if (!solved) throw InputError("no solution: solve has not succeeded yet");
    return *solved;
  }

  const GatherField& gathered(std::vector<PassStats>& gather_passes) {
    gather_passes.clear();
    if (!gather) gather.emplace(context, shape.levels()[0]);
    if (!gather_stale) return *gather;
    work.recorder.clear();
    gather->record(work, {levels[0], op(*solved, 0), beams, results.vertex_exitance(),
                          walks[0].body(levels[0], coefficients.eta(), coefficients.even())});
    work.recorder.submit();
    gather_passes = work.recorder.passes();
    gather_stale = false;
    return *gather;
  }

  glm::vec3 scale() const { return vk::download<gpu::Scale>(context, work.scale)[0].scale; }

  // W/mm^2 per face.
  std::vector<glm::vec3> unscattered(std::span<const float> area) const {
    std::vector<glm::vec3> field(area.size(), glm::vec3(0));
    if (solved_source == Source::diffuse) return field;
    const std::vector<glm::dvec3> power = walks[0].unscattered_power(context, glm::dvec3(scale()));
    for (std::size_t f = 0; f < area.size(); ++f) field[f] = glm::vec3(power[f] / static_cast<double>(area[f]));
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

void Simulation::set_material(const gpu::Material& material) {
  implementation_->coefficients.set(material);
  implementation_->disassemble();
}

void Simulation::set_optical(std::uint32_t level, std::span<const gpu::Optical> optical, float eta) {
  if (level >= level_count()) {
    throw InputError("level " + std::to_string(level) + " of optical: there are " + std::to_string(level_count()));
  }
  implementation_->coefficients.set(implementation_->context, level, optical, eta, implementation_->levels[level]);
  implementation_->disassemble();
}

float Simulation::eta() const {
  implementation_->coefficients.check();
  return implementation_->coefficients.eta();
}

void Simulation::set_beams(std::span<const gpu::BeamRecord> beams) {
  implementation_->light(beams);
  irradiance_changed();
}

void Simulation::set_irradiance(std::uint32_t level, std::span<const glm::vec3> q,
                                const std::optional<glm::vec3>& direction) {
  if (level >= level_count()) {
    throw InputError("level " + std::to_string(level) + " of irradiance: there are " + std::to_string(level_count()));
  }
  const gpu::BeamRecord beam = beam_along(direction);
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

SolveReport Simulation::solve(const SolveOptions& options) {
  return implementation_->solve(options);
}

const std::vector<PassStats>& Simulation::passes() const {
  return implementation_->passes;
}

SurfaceField Simulation::surface_field() const {
  const Implementation& self = *implementation_;
  self.solved_key();
  const Level& level = self.shape.levels()[0];
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
    field.normal.push_back(glm::vec3(glm::normalize(normal)));
    field.area.push_back(static_cast<float>(0.5 * glm::length(normal)));
  }
  field.unscattered = self.unscattered(field.area);
  return field;
}

std::vector<glm::vec3> Simulation::phi() const {
  const Implementation& self = *implementation_;
  const OperatorBuffers& rows = implementation_->op(self.solved_key(), 0);
  const std::size_t moments = rows.model == Model::sp3 ? 2 : 1;
  const auto x = vk::download<glm::vec3>(self.context, rows.x);
  std::vector<glm::vec3> phi = vk::download<glm::vec3>(self.context, rows.to_phi);
  const glm::vec3 scale = self.scale();
  for (std::size_t i = 0; i < phi.size(); ++i) phi[i] *= x[moments * i] * scale;
  return phi;
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
