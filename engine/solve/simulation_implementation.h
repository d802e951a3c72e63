// What a Simulation is made of.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "engine/base/error.h"
#include "engine/reference/exchange.h"
#include "engine/reference/operator.h"
#include "engine/solve/asked_error.h"
#include "engine/solve/beams.h"
#include "engine/solve/body_shape.h"
#include "engine/solve/carried_correction.h"
#include "engine/solve/certificate.h"
#include "engine/solve/coefficients.h"
#include "engine/solve/etendue.h"
#include "engine/solve/gather_field.h"
#include "engine/solve/inter_reflection.h"
#include "engine/solve/level_solver.h"
#include "engine/solve/level_upload.h"
#include "engine/solve/levels_solver.h"
#include "engine/solve/light_error.h"
#include "engine/solve/medium_error.h"
#include "engine/solve/simulation.h"
#include "engine/solve/solver_choice.h"
#include "engine/solve/surface_results.h"
#include "engine/solve/surface_share.h"
#include "engine/solve/transport_correction.h"

namespace quadgraph {

struct Simulation::Implementation {
  device::Device& device;
  BodyShape shape;
  std::vector<PassStats> deformation_passes;
  Refractions refractions;
  std::vector<LevelBuffers> levels;
  BeamBuffers beams;
  std::vector<SourceWalk> walks;  // one per level
  Operators operators;
  Workspace work;
  SurfaceResults results;
  Coefficients coefficients;
  Etendue etendue;
  InterReflection exchange;
  std::optional<BodyTree> tree;                    // of level 0, made at first use
  std::optional<GatherField> gather;               // the same
  std::optional<Gather> gathers_now;               // of the last solution
  std::optional<TransportCorrection> correction;   // made at first use
  std::optional<CarriedCorrection> carried;        // the same
  std::optional<Certifier> certifier;              // the same
  bool certified = false;                          // the last solve, by it
  std::optional<Perturbation> perturbation;        // the same
  std::optional<LightError> light_error;           // the same
  bool corrected = false;                          // the last solution is
  device::Buffer elsewhere;                        // Optical at points_in_tets, of the last solution's medium error
  std::vector<gpu::Optical> corrected_optical;     // at the surface, of the last correction
  std::vector<OpticalSurface> corrected_surfaces;  // the same
  glm::vec3 corrected_g{0};                        // the same
  bool optical_changed = true;                     // since then
  std::vector<PassStats> passes;                   // of the last solve
  bool scaled = false;                             // the scale is that of the present q
  std::optional<OperatorKey> solved;               // by the last solve
  Source solved_source = Source::buried;
  std::map<Model, std::vector<Resolution>> resolution;  // per level, of the present material and shape
  SolverChoice quicker;

  Implementation(device::Device& context_in, const QuadGraph& graph_in)
      : device(context_in),
        shape(graph_in, [&] { device.heed(); }),
        refractions(context_in, static_cast<std::uint32_t>(std::max<std::size_t>(graph_in.bodies().size(), 1))),
        levels(upload_levels(context_in, graph_in.levels(), refractions)),
        work(context_in, largest_dispatch()),
        results(context_in, levels[0]),
        coefficients(context_in, graph_in.levels(), refractions),
        exchange(graph_in) {
    for (std::uint32_t i = 0; i < levels.size(); ++i) walks.emplace_back(device, shape.levels()[i], i);
    light(std::vector{beam_along(std::nullopt)});
  }

  void light(std::span<const gpu::Beam> records) { replace_beams(device, records, beams, levels); }

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
    optical_changed = true;
    quicker.forget();
    resolution.clear();
    operators.disassemble();
    unload();
  }

  void move(std::uint32_t number, std::span<const glm::vec3> positions) {
    shape.move(number, positions);
    const Level& moved = shape.levels()[number];
    device::write_bytes(device, levels[number].vertices, std::as_bytes(moved.vertices));
    if (levels[number].nodes.size() > 0) device::write_bytes(device, levels[number].nodes, std::as_bytes(moved.nodes));
    operators.remeasure(number, moved);
    exchange.remeasure();
    exchange.moved(number);
    if (number == 0) gather.reset();
    forget_shape();
  }

  // What was known of the present shape.
  void forget_shape() {
    if (correction) correction->moved();
    resolution.clear();
    quicker.forget();
    forget_place();
  }

  // What was known of where the body is.
  void forget_place() {
    if (tree) tree->moved();
    if (gather) gather->moved();
    for (SourceWalk& walk : walks) walk.moved();
    solved.reset();
    unload();
  }

  // Work was given up half-way: keeps what was set, and nothing that was derived from it.
  void start_over() {
    work.start_over();
    passes.clear();
    operators.forget();
    coefficients.forget();
    exchange.start_over();
    exchange.put_back(device, levels);
    for (std::uint32_t i = 0; i < levels.size(); ++i) {
      levels[i].links = {};
      levels[i].nodes = {};
      if (shape.set() || !shape.is({})) exchange.moved(i);
    }
    walks.clear();
    for (std::uint32_t i = 0; i < levels.size(); ++i) walks.emplace_back(device, shape.levels()[i], i);
    correction.reset();
    carried.reset();
    certified = false;
    perturbation.reset();
    light_error.reset();
    gather.reset();
    tree.reset();
    gathers_now.reset();
    corrected = false;
    solved.reset();
    disassemble();
  }

  bool deform(std::span<const Deformer> list, const RestBox& box, const std::function<void(Workspace&)>& also) {
    if (shape.is(list)) return false;
    work.recorder.clear();
    if (shape.set() || list.empty()) put_back();
    if (!list.empty()) move_on_device(list, box);
    if (also) also(work);
    work.recorder.submit();
    deformation_passes = work.recorder.passes();
    return true;
  }

  void put_back() {
    if (shape.set()) gather.reset();
    shape.put_back(device, levels);
    operators.put_back();
    exchange.put_back(device, levels);
    forget_shape();
  }

  void move_on_device(std::span<const Deformer> list, const RestBox& box) {
    const ShapeChange change = shape.record(work, list, box, levels);
    if (change == ShapeChange::whole) exchange.turned();
    for (std::uint32_t i = 0; i < levels.size() && change == ShapeChange::bodies; ++i) exchange.moved(i);
    if (change != ShapeChange::shape) return forget_place();  // tets and matrices stay
    work.recorder.submit();
    for (std::uint32_t i = 0; i < levels.size(); ++i) {
      const ShapeState state = shape.measured(i);
      levels[i].inverted = state.inverted > 0;
      operators.remeasure(i, state.conduction);
      exchange.moved(i);
    }
    forget_shape();
  }

  using Check = std::function<void()>;
  SolveReport solve(const SolveOptions& options, const Check& check, const std::function<void(bool)>& relight) {
    check_options(options);
    solved.reset();
    work.recorder.clear();
    const OperatorKey key = key_of(options);
    relight(exchange.refresh(work, shape.levels(), levels, options.exchange_rows));
    make_room(key, options);
    const auto with = [&](SolverKind solver) { return run(key, options, solver); };
    SolveReport report = options.solver == SolverKind::automatic
                             ? quicker.solve(key, options, Multigrid::possible(operators, key), with,
                                             [&] { return work.recorder.passes(); })
                             : with(options.solver);
    warn(options.source, report);
    report.deformed = shape.spoilt();
    corrected = corrects(options);
    if (corrected) correct(key, options, check, report);
    if (!corrected && options.warm && options.carry) carry(key, options, report);
    report.advice = advice(report);
    passes = work.recorder.passes();
    gathers_now.reset();
    solved = key;
    solved_source = options.source;
    return report;
  }

  // Of the correction's operator.
  const BodyBoundaries& correction_boundaries() {
    return refractions.boundaries(correction_key.method, Source::buried, correction_key.model);
  }

  // A correction goes on from what it knows where rays see much the same body.
  void forget_other_material();

  // The operator of the correction on all levels, for the present coefficients.
  void prepare_correction(const BodyBoundaries& boundaries);

  // With the present results on the finest level, for as long as `use` runs.
  void with_solution(const BodyBoundaries& boundaries, const std::function<void(const PerturbedSolution&)>& use);

  // Before the results of the correction, at rest, are taken: the exitance is still that of the solve.
  CorrectedPatches measure_patches(const BodyBoundaries& boundaries);

  void correct(const OperatorKey& key, const SolveOptions& options, const Check& check, SolveReport& report);

  // What the last correction found, where it was of such a solve.
  void carry(const OperatorKey& key, const SolveOptions& options, SolveReport& report);

  // Of the coefficients since the last correction, a share; now: those at the surface.
  double material_change(std::span<const gpu::Optical> now) const;

  // Of the last solution.
  FirstMoment fluence() {
    return corrected ? FirstMoment{.x = correction->fluence().address()}
                     : first_moment_of(operators.at(solved_key(), 0));
  }

  OperatorKey key_of(const SolveOptions& options) {
    if (options.method == Method::shortest_path) throw InputError("shortest-path: has no levels to solve on");
    check_method(shape.levels()[0], options.method);
    coefficients.check();
    return {options.method, coefficients.resolve(work, options.model, options.method, options.source, levels)};
  }

  void make_room(const OperatorKey& key, const SolveOptions& options) {
    coefficients.make_room(key.method, levels);
    for (std::uint32_t i = 0; i < levels.size() && !on_vertices(key.method); ++i) {
      const bool there = levels[i].nodes.size() > 0;
      upload_graph(device, shape.levels()[i], i, levels[i]);
      if (!there) shape.record_nodes(work, i, levels[i]);
    }
    const bool two_steps = (options.smoothing > 0 ? options.smoothing : rules_of(options.solver).smoothing) == 2;
    operators.rounded(key, coefficients.packed_rounding(key.model));
    operators.create(device, shape.levels(), key, coefficients.even(), two_steps);
    const std::optional<std::uint32_t> bounced = bounces_wanted(options) ? exchange.level() : std::nullopt;
    if (bounced) exchange.make_room(work, levels);
    for (std::uint32_t i = 0; i < levels.size() && options.source == Source::buried; ++i) {
      walks[i].make_room(device, levels[i], key.method, bounced && i <= *bounced);
    }
    if (!corrects(options)) return;
    correction_room(options.sweep_points);
    if (options.warm || light_error) return;
    perturbation.emplace(device, shape.levels()[0]);
    light_error.emplace(device, shape.levels()[0]);
  }

  void correction_room(std::uint32_t points);
  bool corrected_forward() const { return corrected && corrected_g != glm::vec3(0); }  // the last solution
  bool goes_forward() const { return coefficients.angles().g != glm::vec3(0); }

  GatherField& gather_room() {
    if (!tree) tree.emplace(device, shape.levels()[0], "gather");
    if (!gather) gather.emplace(device, shape.levels()[0], *tree);
    if (etendue.bends()) gather->make_room_shared(device, shape.levels()[0]);
    return *gather;
  }

  std::vector<gpu::Optical> optical_at(std::uint32_t level) { return coefficients.at(level, shape.samples(level)); }

  const std::vector<Resolution>& resolution_with(Model model) {
    std::vector<Resolution>& found = resolution[model];
    for (auto i = static_cast<std::uint32_t>(found.size()); i < levels.size(); ++i) {
      found.push_back(resolution_of(shape.samples(i), optical_at(i), refractions.eta(), model));
    }
    return found;
  }

  void warn(Source source, SolveReport& report) {
    if (report.method == Method::fem) {
      report.mesh_warning = mesh_warning(resolution_with(report.model)[report.finest]);
      const std::string inside = inside_warning(optical_at(report.finest), shape.edge(report.finest), shape.chord());
      report.mesh_warning += (report.mesh_warning.empty() || inside.empty() ? "" : "; ") + inside;
    }
    report.model_warning = model_warning(optical_at(0), refractions.eta(), shape.chord(), source, report.model);
  }

  SolveReport run(const OperatorKey& key, const SolveOptions& options, SolverKind solver) {
    std::function<std::span<const Resolution>()> known;
    if (key.method == Method::fem && options.source == Source::buried) {
      known = [&] { return std::span<const Resolution>(resolution_with(key.model)); };
    }
    const SolveParts parts{work,         levels,      beams,    walks,  operators, results,
                           coefficients, refractions, exchange, scaled, known};
    return LevelsSolver(parts, key, options, solver).run();
  }

  const OperatorKey& solved_key() const {
    if (!solved) throw InputError("no solution: solve has not succeeded yet");
    return *solved;
  }

  const GatherField& gathered(Gather what, std::vector<PassStats>& gather_passes) {
    gather_passes.clear();
    if (gather_room(); gathers_now == what) return *gather;
    work.recorder.clear();
    walks[0].record_cells(work, levels[0]);
    gpu::BodyRef body = walks[0].body(levels[0], coefficients.even());
    const bool forwards = corrected_forward() && what != Gather::single;
    const ForwardScattering* forward = forwards ? &correction->forward() : nullptr;
    if (forward != nullptr) body.optical = forward->optical().address();
    GatherInput input{levels[0], fluence(), beams, results.vertex_exitance(), body, *tree};
    if (corrected) input.first.emplace(correction->first());
    input.forward = forward;
    what == Gather::single ? gather->record_single(work, input) : gather->record(work, input);
    work.recorder.submit();
    gather_passes = work.recorder.passes();
    gathers_now = what;
    return *gather;
  }

  const LevelBuffers& solved_level(std::uint32_t number) const {
    solved_key();
    if (number < levels.size()) return levels[number];
    throw InputError("level " + std::to_string(number) + ": the body has " + std::to_string(levels.size()));
  }

  std::vector<glm::vec3> exitance_on(std::uint32_t number) {
    OperatorBuffers& op = operators.at(solved_key(), number);
    if (number >= levels.size() || !op.solved) {
      throw InputError("level " + std::to_string(number) + " of exitance: the last solve did not go over it");
    }
    const BodyBoundaries& boundaries = refractions.boundaries(solved->method, solved_source, solved->model);
    return exitance_of(device, work, {levels[number], op, solved->method, boundaries, nullptr});
  }

  glm::vec3 scale() const { return device::download<gpu::Scale>(device, work.scale)[0].scale; }

  // W/mm^2 per carrier, of the basic fluence.
  std::vector<glm::vec3> basic_phi() {
    const OperatorBuffers& rows = operators.at(solved_key(), 0);
    const std::size_t moments = !corrected && rows.model == Model::sp3 ? 2 : 1;
    const auto x = device::download<glm::vec3>(device, corrected ? correction->fluence() : rows.x);
    std::vector<glm::vec3> field(rows.count, glm::vec3(1));
    if (rows.to_phi.size() > 0) field = device::download<glm::vec3>(device, rows.to_phi);
    const glm::vec3 unit = scale();
    for (std::size_t i = 0; i < field.size(); ++i) field[i] *= x[moments * i] * unit;
    return field;
  }

  // W per face.
  std::vector<glm::dvec3> unscattered_power() const {
    const glm::dvec3 unit(scale());
    if (!corrected_forward()) return walks[0].unscattered_power(device, unit);
    return powers(device::download<std::uint32_t>(device, correction->forward().leaving()), unit);
  }

  // W/mm^2 per face.
  std::vector<glm::vec3> unscattered(std::span<const float> area) const {
    std::vector<glm::vec3> field(area.size(), glm::vec3(0));
    if (solved_source == Source::diffuse) return field;
    const std::vector<glm::dvec3> power = unscattered_power();
    for (std::size_t f = 0; f < area.size(); ++f) {
      if (area[f] > 0) field[f] = glm::vec3(power[f] / static_cast<double>(area[f]));
    }
    return field;
  }
};

}  // namespace quadgraph
