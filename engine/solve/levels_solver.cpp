#include "engine/solve/levels_solver.h"

#include "engine/graph/exchange.h"
#include "engine/solve/assembly.h"
#include "engine/solve/level_solver.h"

namespace quadgraph {
namespace {

bool same(const Boundary& a, const Boundary& b) {
  return a.k11 == b.k11 && a.k12 == b.k12 && a.k22 == b.k22;
}

}  // namespace

LevelsSolver::LevelsSolver(const SolveParts& parts, const OperatorKey& key, const SolveOptions& options)
    : parts_(parts),
      key_(key),
      options_(options),
      boundary_(boundary_of(key.method, options.source, key.model, parts.coefficients.eta())) {
  report_.method = key.method;
  report_.solver = options.solver;
  report_.source = options.source;
  report_.model = key.model;
  report_.exchange_age = parts.exchange.age();
  report_.inter_reflection = bounces_wanted(options) && parts.exchange.baked();
}

SolveReport LevelsSolver::run() {
  for (SourceWalk& walk : parts_.walks) walk.forget_again();
  record_setup();
  if (!report_.inter_reflection || options_.bounces == 0) parts_.exchange.record_none(parts_.work, parts_.levels);
  solve_levels();
  finish();
  return report_;
}

Solved LevelsSolver::solved(std::uint32_t level) {
  const bool buried = options_.source == Source::buried;
  return {parts_.levels[level], op(level), key_.method, boundary_, buried ? &parts_.walks[level] : nullptr};
}

void LevelsSolver::record_load(std::uint32_t level) {
  OperatorBuffers& rows = op(level);
  if (rows.loaded == options_.source) return;
  const LevelBuffers& buffers = parts_.levels[level];
  if (options_.source == Source::buried) {
    SourceWalk& walk = parts_.walks[level];
    walk.record(parts_.work, buffers, parts_.beams, key_.method, parts_.coefficients.eta(), parts_.coefficients.even());
    walk.record_right_hand_side(parts_.work, buffers, key_.method, rows);
  } else {
    record_diffuse_load(parts_.work, buffers, key_.method, boundary_, rows);
  }
  rows.loaded = options_.source;
}

// b with the light that enters again.
void LevelsSolver::record_load_again(std::uint32_t level) {
  SourceWalk& walk = parts_.walks[level];
  const LevelBuffers& buffers = parts_.levels[level];
  walk.record_again(parts_.work, buffers, parts_.beams, key_.method, parts_.coefficients.eta(),
                    parts_.coefficients.even());
  walk.record_right_hand_side(parts_.work, buffers, key_.method, op(level));
  op(level).loaded.reset();
}

void LevelsSolver::record_setup() {
  parts_.coefficients.record(parts_.work, parts_.levels);
  if (!parts_.scaled) record_scale(parts_.work, parts_.levels[0]);
  parts_.scaled = true;
  for (std::uint32_t i = 0; i < parts_.levels.size(); ++i) {
    OperatorBuffers& rows = op(i);
    if (!rows.assembled || !same(*rows.assembled, boundary_)) {
      record_assembly(parts_.work, parts_.levels[i], key_.method, boundary_, parts_.coefficients.even(), rows);
      rows.assembled = boundary_;
      rows.damped = false;
      rows.loaded.reset();
    }
    if (!rows.damped && options_.solver == SolverKind::cascade) {
      record_damping(parts_.work, key_.method, rows);
      rows.damped = true;
    }
    record_load(i);
  }
}

void LevelsSolver::solve_levels() {
  for (auto i = static_cast<std::uint32_t>(parts_.levels.size()); i-- > 0;) {
    if (report_.inter_reflection && i <= parts_.exchange.level()) {
      parts_.exchange.record_beam(parts_.work, parts_.levels, i, parts_.coefficients.eta());
      if (parts_.exchange.any()) record_load_again(i);
    }
    solve(i);
    if (report_.inter_reflection && i == parts_.exchange.level()) bounce();
  }
}

// From the solution of the next coarser level.
void LevelsSolver::solve(std::uint32_t level) {
  if (level + 1 == parts_.levels.size()) {
    parts_.work.recorder.fill(op(level).x, 0);
  } else {
    parts_.operators.record_transfer(parts_.work, key_, level);
    if (level == 0) parts_.results.record_coarse(parts_.work, solved(0));
  }
  report_.levels.push_back(solve_level(parts_.work, op(level), level, options_));
}

// On the level with the exchange, from the solution it has.
void LevelsSolver::bounce() {
  InterReflection& exchange = parts_.exchange;
  const std::uint32_t level = *exchange.level();
  if (level == 0 && parts_.levels.size() > 1 && !exchange.any()) {
    // The finest level's own error, before it has bounces that the coarser ones do not have.
    parts_.results.record(parts_.work, solved(0));
    parts_.work.recorder.submit();
    report_.error = parts_.results.error();
  }
  LevelReport& total = report_.levels.back();
  for (std::uint32_t left = options_.bounces > 0 ? options_.bounces : max_bounces; left > 0; --left) {
    const glm::dvec3 before = exchange.power();
    exchange.record_bounce(parts_.work, solved(level), parts_.coefficients.eta());
    record_load_again(level);
    const std::uint32_t iterations = total.iterations;
    total = solve_level(parts_.work, op(level), level, options_);
    total.iterations += iterations;
    report_.bounces.push_back(exchange.power() - before);
    if (options_.bounces == 0 && exchange.converged(options_.tolerance / 10)) return;
  }
}

void LevelsSolver::finish() {
  parts_.results.record(parts_.work, solved(0));
  parts_.work.recorder.submit();
  report_.energy = energy();
  report_.clipped = parts_.results.clipped();
  const bool bounced_on_finest = report_.inter_reflection && parts_.exchange.level() == 0u;
  if (parts_.levels.size() > 1 && !bounced_on_finest) report_.error = parts_.results.error();
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
