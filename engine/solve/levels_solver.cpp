#include "engine/solve/levels_solver.h"

#include <algorithm>
#include <cmath>

#include "engine/reference/exchange.h"
#include "engine/solve/asked_error.h"
#include "engine/solve/assembly.h"
#include "engine/solve/mesh_error.h"
#include "engine/solve/solver_choice.h"
#include "engine/solve/surface_share.h"

namespace quadgraph {
namespace {

// Cycles on a level that only starts the next finer one, where the finest gets a given number: one would do for the
// start, but not for the error that is taken from the difference between the two. And on the finest in the first
// submission.
constexpr std::uint32_t coarse_cycles = 2, first_cycles = 6;

// Tolerances that such a level is solved to where the finest has one: what is left of its error counts as a difference
// of the meshes, which on thin bodies is small.
constexpr double coarse_share = 2;

// Bounces in the first submission: each brings in about an eighth of the one before, and what is left is to be a tenth
// of the usual tolerance.
constexpr std::uint32_t first_bounces = 5, more_bounces = 2;

// What light that enters again may be off by, in tolerances: it is a tenth of all light at most.
constexpr double exchange_share = 5;

// A bounce that brings in no more than this share of all light is the last: single precision would not tell another.
constexpr double least_bounce = 1e-6;

// Rounds of iterations behind a solution that leaves more light unaccounted for than the tolerance, and the tolerance
// down to which that is asked: below it single precision is what is left.
constexpr std::uint32_t most_rounds = 4;
constexpr double least_unbalanced = 1e-4;

}  // namespace

LevelsSolver::LevelsSolver(const SolveParts& parts, const OperatorKey& key, const SolveOptions& options,
                           SolverKind solver)
    : parts_(parts),
      key_(key),
      options_(options),
      boundaries_(parts.refractions.boundaries(key.method, options.source, key.model)),
      solvers_(parts.operators.count(key)) {
  report_.method = key.method;
  report_.solver = solver;
  report_.source = options.source;
  report_.model = key.model;
  report_.exchange_age = parts.exchange.age();
  report_.inter_reflection = bounces_wanted(options) && parts.exchange.baked();
  const PossibleSolver possible = possible_solver(parts.operators, key, solver);
  report_.solver = possible.solver;
  report_.replaced = possible.replaced;
}

SolveReport LevelsSolver::run() {
  for (SourceWalk& walk : parts_.walks) walk.forget_again();
  parts_.coefficients.record(parts_.work, parts_.levels);
  if (!parts_.scaled) record_scale(parts_.work, parts_.levels[0]);
  parts_.scaled = true;
  const auto coarsest = static_cast<std::uint32_t>(solvers_.size()) - 1;
  finest_ = options_.error > 0 && key_.method == Method::fem ? coarsest : 0;
  start_over();
  if (!report_.inter_reflection || (options_.bounces == 0 && !warm_)) {
    parts_.exchange.record_none(parts_.work, parts_.levels);
  }
  parts_.exchange.begin();
  while (true) {
    solve_down_to(finest_);
    settle();
    if (finest_ == 0 || (reached() && (!report_.inter_reflection || bounces_reach(finest_)))) break;
    next_ = --finest_;  // from the solution that was found not to be good enough
  }
  finish();
  return report_;
}

// Where the levels to be solved begin.
void LevelsSolver::start_over() {
  next_ = static_cast<std::uint32_t>(solvers_.size()) - 1;
  if (rules_of(report_.solver).alone) {
    next_ = std::max(finest_, report_.inter_reflection ? parts_.exchange.level().value_or(0) : 0);
  }
  warm_ = options_.warm;
  for (std::uint32_t level = finest_; level <= next_; ++level) warm_ = warm_ && op(level).solved;
}

// Whether light that bounced is part of what a level is solved for: not on those coarser than where it bounces.
bool LevelsSolver::bounces_reach(std::uint32_t level) const {
  return report_.inter_reflection && parts_.exchange.level() && level <= *parts_.exchange.level();
}

bool LevelsSolver::bounces_on(std::uint32_t level) const {
  return report_.inter_reflection && level == parts_.exchange.level();
}

Solved LevelsSolver::solved(std::uint32_t level) {
  const bool buried = options_.source == Source::buried;
  return {parts_.levels[level], op(level), key_.method, boundaries_, buried ? &parts_.walks[level] : nullptr};
}

WalkTask LevelsSolver::walk_task() const {
  return {key_.method, parts_.coefficients.even(), options_.mean_rays};
}

void LevelsSolver::record_load(std::uint32_t level) {
  OperatorBuffers& rows = op(level);
  const Load load{options_.source, options_.mean_rays};
  if (rows.loaded == load) return;
  const LevelBuffers& buffers = parts_.levels[level];
  if (options_.source == Source::buried) {
    SourceWalk& walk = parts_.walks[level];
    walk.record(parts_.work, buffers, parts_.beams, walk_task());
    walk.record_right_hand_side(parts_.work, buffers, key_.method, rows);
  } else {
    record_diffuse_load(parts_.work, buffers, key_.method, boundaries_, rows);
  }
  rows.loaded = load;
}

// b with the light that enters again.
void LevelsSolver::record_load_again(std::uint32_t level) {
  SourceWalk& walk = parts_.walks[level];
  const LevelBuffers& buffers = parts_.levels[level];
  walk.record_again(parts_.work, buffers, parts_.beams, walk_task());
  walk.record_right_hand_side(parts_.work, buffers, key_.method, op(level));
  op(level).loaded.reset();
}

void LevelsSolver::record_setup(std::uint32_t level) {
  record_rows(parts_.work, parts_.levels[level], key_.method, boundaries_, parts_.coefficients.even(),
              rules_of(report_.solver).bound, op(level));
}

void LevelsSolver::record_light(std::uint32_t level) {
  if (!op(level).weighed) record_surface_share(parts_.work, parts_.levels[level], key_.method, boundaries_, op(level));
  op(level).weighed = true;
  record_load(level);
  if (!bounces_reach(level)) return;
  parts_.exchange.record_beam(parts_.work, parts_.levels, level);
  if (parts_.exchange.any()) record_load_again(level);
}

// x before the first iteration, and the exitance of what comes from the coarser level. In motion x follows what changes
// on the coarser levels: where the light jumps that is as good a start as one from nothing, and else a better one.
void LevelsSolver::record_first(std::uint32_t level) {
  const bool alone = rules_of(report_.solver).alone || level + 1 == solvers_.size() || !solvers_[level + 1];
  if (!alone) {
    const device::Buffer& target = warm_ ? op(level).p : op(level).x;
    parts_.operators.record_transfer(parts_.work, key_, level, target, op(level).state);
    solvers_[level]->record_origin(target);
    const OperatorBuffers& rows = op(level);
    record_surface_dimmest(parts_.work, rows.surface_start, rows.surface_share, rows.surface_count);
  }
  if (cycles() && !alone && !warm_ && level == finest_) solvers_[level]->record_relaxation();
  if (warm_) {
    parts_.operators.record_follow(parts_.work, key_, level, !alone);
  } else if (alone) {
    parts_.work.recorder.fill(op(level).x, 0);
  }
}

void LevelsSolver::approach(std::uint32_t level) {
  record_setup(level);
  record_light(level);
  set_solver(level);
  record_first(level);
  op(level).solved = false;  // until it is: a failure leaves nothing to go on from
}

void LevelsSolver::set_solver(std::uint32_t level) {
  const bool last = level == finest_;
  LevelTask task{
      .solver = report_.solver, .boundaries = boundaries_.on_device, .max_iterations = options_.max_iterations};
  task.tolerance = algebraic_wanted();
  task.smoothing = options_.smoothing > 0 ? options_.smoothing : rules_of(report_.solver).smoothing;
  task.start = !last && cycles();
  task.fixed = options_.cycles > 0 && (last || (task.start && !bounces_on(level)));
  if (task.fixed) task.max_iterations = task.start ? coarse_cycles : options_.cycles;
  if (task.start) task.tolerance *= bounces_on(level) ? exchange_share : coarse_share;
  if (level + 1 < solvers_.size()) task.active_layers = options_.active_layers;
  solvers_[level].emplace(parts_.work, parts_.operators, key_, level, task);
}

// Iterations behind the present b.
void LevelsSolver::iterate(std::uint32_t level) {
  LevelSolver& solver = *solvers_[level];
  if (!cycles()) return solver.run();
  solver.record_start();
  solver.record(std::min(first_cycles, solver.max_iterations()));
  solver.record_check();
}

void LevelsSolver::solve(std::uint32_t level) {
  approach(level);
  iterate(level);
  record_solved(level);
  // A level's own error is that of the light before it bounces, which the coarser ones do not have.
  record_difference(level);
  if (bounces_on(level)) bounce(options_.bounces > 0 ? options_.bounces : first_bounces);
}

void LevelsSolver::record_solved(std::uint32_t level) {
  op(level).solved = true;
  parts_.work.recorder.copy(parts_.work.scale, op(level).unit, sizeof(glm::vec3));
}

void LevelsSolver::record_difference(std::uint32_t level) {
  if (level + 1 < solvers_.size() && solvers_[level + 1]) solvers_[level]->record_difference();
}

void LevelsSolver::solve_down_to(std::uint32_t finest) {
  while (true) {
    solve(next_);
    if (next_ == finest) return;
    --next_;
  }
}

bool LevelsSolver::bounced_enough() const {
  const double wanted = (options_.error > 0 ? options_.error : options_.tolerance) / 10;
  return options_.bounces > 0 || parts_.exchange.count() >= max_bounces ||
         parts_.exchange.converged(std::max(wanted, least_bounce));
}

// On the level with the exchange, from the solution it has.
void LevelsSolver::bounce(std::uint32_t bounces) {
  const std::uint32_t level = *parts_.exchange.level();
  for (std::uint32_t left = bounces; left > 0; --left) {
    parts_.exchange.record_bounce(parts_.work, solved(level));
    record_load_again(level);
    iterate(level);
    if (!cycles() && bounced_enough()) return;
  }
}

void LevelsSolver::bounce_more() {
  const std::uint32_t exchange = *parts_.exchange.level();
  bounce(more_bounces);
  for (std::uint32_t level = exchange; level-- > finest_;) {
    record_light(level);
    iterate(level);
    record_difference(level);
  }
}

// Until the finest level and the bounces are what was asked for.
void LevelsSolver::settle() {
  submit();
  while (true) {
    LevelSolver& solver = *solvers_[finest_];
    if (solver.failed()) {
      replace();
    } else if (bounces_reach(finest_) && !bounced_enough()) {
      bounce_more();
    } else if (solver.running()) {
      solver.record(first_cycles);
      solver.record_check();
      if (!bounces_on(finest_)) record_difference(finest_);
    } else if (!balanced() && rounds_ < most_rounds) {
      ++rounds_;
      iterate(finest_);
      if (!bounces_on(finest_)) record_difference(finest_);
    } else {
      return;
    }
    submit();
  }
}

// Conjugate gradients with the diagonal, from what there is, or from nothing if that is no solution.
void LevelsSolver::replace() {
  const LevelSolver& failed = *solvers_[finest_];
  report_.replaced = std::string(name_of(report_.solver)) + " by dpcg: " + failed.failure();
  report_.solver = SolverKind::dpcg;
  const bool usable = failed.state().status != gpu::SOLVE_NOT_FINITE && failed.state().status != gpu::SOLVE_DIVERGED;
  if (usable) {
    op(finest_).solved = false;
    set_solver(finest_);
    iterate(finest_);
    record_solved(finest_);
    return record_difference(finest_);
  }
  for (std::uint32_t level = 0; level < solvers_.size(); ++level) op(level).solved = false;
  start_over();
  solve_down_to(finest_);
}

// What leaves level 0, of the solution carried there.
void LevelsSolver::record_results() {
  for (std::uint32_t level = finest_; level-- > 0;) {
    parts_.operators.record_transfer(parts_.work, key_, level, op(level).x, op(finest_).state);
    record_solved(level);
  }
  if (finest_ > 0 && options_.source == Source::buried) {
    parts_.walks[0].record(parts_.work, parts_.levels[0], parts_.beams, walk_task());
  }
  parts_.results.record(parts_.work, solved(0));
}

void LevelsSolver::submit() {
  record_results();
  for (auto& solver : solvers_) {
    if (solver) solver->record_state();
  }
  parts_.work.recorder.submit([&] {
    if (parts_.resolution) parts_.resolution();
  });
  for (auto& solver : solvers_) {
    if (solver) solver->take();
  }
  take_error();
}

void LevelsSolver::take_error() {
  const LevelSolver& solver = *solvers_[finest_];
  report_.algebraic = solver.algebraic();
  if (report_.algebraic) {
    const double least = unbalanced();
    report_.algebraic->whole = std::max(report_.algebraic->whole, least);
    for (double* part : {&report_.algebraic->unlit, &report_.algebraic->dimmest}) {
      if (*part > 0) *part = std::max(*part, least);
    }
  }
  report_.error.reset();
  report_.mesh_error.reset();
  if (finest_ + 1 == solvers_.size() || !solvers_[finest_ + 1]) return;
  std::optional<ErrorEstimate> coarser;
  if (finest_ + 2 < solvers_.size() && solvers_[finest_ + 2]) coarser = solvers_[finest_ + 1]->difference();
  ErrorEstimate mesh = mesh_error(solver.difference(), coarser);
  if (parts_.resolution) mesh.whole = std::max(mesh.whole, parts_.resolution()[finest_].error);
  report_.mesh_error = mesh;
  const ErrorEstimate left = report_.algebraic.value_or(ErrorEstimate{});
  report_.error = by_parts([](double a, double b) { return std::hypot(a, b); }, mesh, left);
}

void LevelsSolver::finish() {
  double entries = 0;
  for (auto i = static_cast<std::uint32_t>(solvers_.size()); i-- > 0;) {
    if (!solvers_[i]) continue;
    report_.levels.push_back(solvers_[i]->report());
    entries += solvers_[i]->entries();
    if (options_.source == Source::buried) report_.walk_segments += parts_.walks[i].segments();
  }
  report_.finest = finest_;
  report_.cycles = options_.cycles;
  if (options_.error > 0 && !reached()) report_.missed = missed(report_.error, options_.error);
  if (stopped_short()) report_.stopped = stopped(report_.levels.back());
  report_.work = entries / op(0).entries;
  report_.bounces = parts_.exchange.bounces();
  report_.energy = energy();
  report_.clipped = parts_.results.clipped();
}

bool LevelsSolver::reached() const {
  return report_.error && certain(*report_.error, options_.error);
}

// Whether the level that was solved last did not get to its tolerance, and no estimate says that it is good enough.
bool LevelsSolver::stopped_short() const {
  if (options_.cycles > 0 || report_.levels.back().converged) return false;
  return options_.error == 0 || !report_.algebraic || !reached();
}

// The light that is unaccounted for on level 0, where all of it can be told.
double LevelsSolver::unbalanced() const {
  if (finest_ > 0 || !conserves(key_.method)) return 0;
  return quadgraph::unbalanced(energy(), parts_.results.energy());
}

double LevelsSolver::algebraic_wanted() const {
  return options_.error > 0 ? algebraic_share * options_.error : options_.tolerance;
}

bool LevelsSolver::balanced() const {
  return options_.cycles > 0 || algebraic_wanted() < least_unbalanced || unbalanced() <= algebraic_wanted();
}

Energy LevelsSolver::energy() const {
  Energy energy = parts_.results.energy();
  if (options_.source == Source::buried) {
    const WalkPower power = parts_.walks[0].power();
    energy.absorbed += power.absorbed;
    energy.unscattered_out = power.unscattered;
  }
  if (report_.inter_reflection) energy.re_entered = parts_.exchange.power();
  return energy;
}

}  // namespace quadgraph
