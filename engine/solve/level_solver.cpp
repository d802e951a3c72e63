#include "engine/solve/level_solver.h"

#include <algorithm>
#include <cstddef>

#include "engine/base/error.h"
#include "interface/solver/cg_direction.comp.h"
#include "interface/solver/cg_multiply.comp.h"
#include "interface/solver/cg_start.comp.h"
#include "interface/solver/cg_update.comp.h"
#include "interface/solver/correct.comp.h"
#include "interface/solver/sweep.comp.h"
#include "interface/surface/surface_change.comp.h"
#include "shaders/surface/surface_shared.h"

namespace quadgraph {
namespace {

// Tolerances below this are close to what single precision gives: the true residual has the last word.
constexpr double tight = 1e-4;

// A batch of sweeps that leaves more of the residual than this has met the limit of single precision.
constexpr float least_progress = 1 - 1e-4f;

ErrorEstimate by_part(const glm::vec3& of_state) {
  return {of_state.x, of_state.y, of_state.z};
}

std::uint64_t gate_of(std::uint32_t level) {
  return offsetof(gpu::SolveState, gate) + level * sizeof(glm::uvec3);
}

}  // namespace

// Rates and limits of the looks are measured on bunnies and thin bodies, six materials, both models: healthy cycles
// have rates of .15 to .5.
SolverRules rules_of(SolverKind solver) {
  using enum SolverRules::Step;
  switch (solver) {
    case SolverKind::fmg_pcg:
    case SolverKind::automatic:
      break;
    case SolverKind::vcycle:
      return {.step = cycle,
              .cycles = true,
              .bound = StepBound::majorant,
              .smoothing = 2,
              .window = 1,
              .batch = 8,
              .looks = {1, 0.1f, 2, 0.9f}};
    case SolverKind::dpcg:
      return {.step = conjugate_gradients,
              .bound = StepBound::none,
              .window = 8,
              .batch = 32,
              .looks = {2, 0.25f, 0, 1.0f}};
    case SolverKind::cascade:
      return {.step = sweep, .any_matrix = true, .window = 8, .batch = 64, .looks = {3, 0.1f, 0, 1.0f}};
    case SolverKind::jacobi:
      return {.step = sweep, .any_matrix = true, .alone = true, .window = 8, .batch = 64, .looks = {3, 0.1f, 0, 1.0f}};
  }
  return {.step = conjugate_gradients,
          .cycles = true,
          .bound = StepBound::majorant,
          .window = 1,
          .batch = 8,
          .looks = {1, 0.1f, 3, 0.7f}};
}

LevelSolver::LevelSolver(Workspace& work, Operators& operators, const OperatorKey& key, std::uint32_t level,
                         const LevelTask& task)
    : work_(work), operators_(operators), key_(key), level_(level), task_(task), rules_(rules_of(task.solver)) {
  if (rules_.cycles) multigrid_.emplace(work, operators, key, task.smoothing);
}

template <typename Push>
void LevelSolver::dispatch(LazyPass& pass, const Push& push, std::uint64_t gate, const char* name) {
  work_.recorder.dispatch_indirect(pass, push, op().state, gate, name);
}

std::uint64_t LevelSolver::start_bytes() const {
  return op().product_bytes() + 5 * op().field_bytes() * op().count;
}

void LevelSolver::dispatch_start(std::uint32_t what) {
  const OperatorBuffers& rows = op();
  const gpu::CgStartPush push{.rows = rows.rows(),
                              .b = rows.b.address(),
                              .x = rows.x.address(),
                              .r = rows.r.address(),
                              .p = rows.p.address(),
                              .state = rows.state.address(),
                              .reduction = work_.reduction.address(),
                              .count = rows.count,
                              .tolerance = static_cast<float>(task_.tolerance),
                              .what = what,
                              .multigrid = multigrid_ ? 1u : 0u};
  if (what == gpu::START_FIRST || what == gpu::START_AGAIN) {
    work_.recorder.dispatch(work_.passes.of(shader::cg_start, rows.model, rows.format), push, rows.count, "residual",
                            start_bytes());
  } else {
    const std::uint64_t gate = what == gpu::START_CHECK ? offsetof(gpu::SolveState, check) : gate_of(level_);
    dispatch(work_.passes.of(shader::cg_start, rows.model, rows.format), push, gate, "residual");
  }
}

void LevelSolver::record_surface(const device::Buffer& x, const device::Buffer& before, std::uint32_t what) {
  const OperatorBuffers& rows = op();
  const SolverLooks& looks = rules_.looks;
  const gpu::SurfaceChangePush push{.x = x.address(),
                                    .to_phi = rows.to_phi.address(),
                                    .share = rows.surface_share.address(),
                                    .boundaries = task_.boundaries,
                                    .before = before.address(),
                                    .scale = work_.scale.address(),
                                    .state = rows.state.address(),
                                    .reduction = work_.reduction.address(),
                                    .first = rows.surface_first,
                                    .count = rows.surface_count,
                                    .what = what,
                                    .level = level_,
                                    .verify = verified() ? 1u : 0u,
                                    .stall_limit = looks.stall_limit,
                                    .max_iterations = task_.max_iterations,
                                    .looks = looks.first,
                                    .by_change = rules_.step == Step::sweep ? 1u : 0u,
                                    .least_rate = looks.least_rate,
                                    .slow_rate = looks.slow_rate,
                                    // Far from the surface a jump of kappa can hide errors from it for long.
                                    .by_residual = rules_.step == Step::conjugate_gradients && !rules_.cycles ? 1u : 0u,
                                    .tolerance = task_.fixed ? 0.0f : static_cast<float>(task_.tolerance)};
  const std::uint64_t bytes =
      rows.surface_count * (rows.field_bytes() + sizeof(gpu::SurfaceShare) + 2 * std::uint64_t{sizeof(glm::vec3)});
  if (what == gpu::SURFACE_CHANGE) {
    dispatch(work_.passes.of(shader::surface_change, key_.model), push, offsetof(gpu::SolveState, surface),
             "surface change");
  } else {
    work_.recorder.dispatch(work_.passes.of(shader::surface_change, key_.model), push, rows.surface_count,
                            "surface change", bytes);
  }
}

void LevelSolver::record_origin(const device::Buffer& x) {
  record_surface(x, op().surface_start, gpu::SURFACE_STORE);
}

void LevelSolver::record_relaxation() {
  multigrid_->record_relaxation(level_);
  entries_ += op().entries;
}

void LevelSolver::record_start() {
  record_surface(op().x, op().surface_before, gpu::SURFACE_STORE);
  dispatch_start(started_ ? gpu::START_AGAIN : gpu::START_FIRST);
  // What stays as it is must be in both vectors of a relaxation.
  if (active_rows() < op().count) work_.recorder.copy(op().x, op().product, op().x.size());
  started_ = true;
  unlooked_ = 0;
  entries_ += op().entries;
}

bool LevelSolver::verified() const {
  return !task_.fixed && task_.tolerance < tight;
}

void LevelSolver::record_check() {
  if (verified()) dispatch_start(gpu::START_CHECK);
}

void LevelSolver::record_difference() {
  record_surface(op().x, op().surface_start, gpu::SURFACE_DIFFERENCE);
}

void LevelSolver::record_cg() {
  const OperatorBuffers& rows = op();
  const std::uint32_t multigrid = multigrid_ ? 1 : 0;
  const gpu::CgMultiplyPush multiply{rows.rows(),          rows.p.address(),          rows.product.address(),
                                     rows.state.address(), work_.reduction.address(), rows.count};
  const gpu::CgUpdatePush update{.diagonal = rows.rows().diagonal,
                                 .p = rows.p.address(),
                                 .product = rows.product.address(),
                                 .x = rows.x.address(),
                                 .r = rows.r.address(),
                                 .state = rows.state.address(),
                                 .reduction = work_.reduction.address(),
                                 .count = rows.count,
                                 .multigrid = multigrid};
  const device::Buffer& z = multigrid_ ? multigrid_->correction(level_) : rows.z;
  const gpu::CgDirectionPush direction{rows.rows().diagonal, rows.r.address(), z.address(), rows.p.address(),
                                       rows.state.address(), rows.count,       multigrid};
  // The first direction of plain conjugate gradients comes with the start.
  if (multigrid_) {
    multigrid_->record(level_);
    dispatch(work_.passes.of(shader::cg_direction, rows.model, rows.format), direction, gate_of(level_),
             "cg-direction");
  }
  dispatch(work_.passes.of(shader::cg_multiply, rows.model, rows.format), multiply, gate_of(level_), "cg-multiply");
  dispatch(work_.passes.of(shader::cg_update, rows.model, rows.format), update, gate_of(level_), "cg-update");
  if (!multigrid_)
    dispatch(work_.passes.of(shader::cg_direction, rows.model, rows.format), direction, gate_of(level_),
             "cg-direction");
}

// x += z, then the residual anew.
void LevelSolver::record_cycle() {
  const OperatorBuffers& rows = op();
  multigrid_->record(level_);
  const gpu::CorrectPush correct{multigrid_->correction(level_).address(), rows.x.address(), rows.state.address(),
                                 rows.count};
  dispatch(work_.passes.of(shader::correct, key_.model), correct, gate_of(level_), "correction");
  dispatch_start(gpu::START_RESIDUAL);
}

std::uint32_t LevelSolver::active_rows() const {
  const std::vector<std::uint32_t>& ends = op().layer_ends;
  return task_.active_layers > 0 && task_.active_layers < ends.size() ? ends[task_.active_layers] : op().count;
}

void LevelSolver::record_sweeps(std::uint32_t sweeps) {
  const OperatorBuffers& rows = op();
  const std::uint32_t active = active_rows();
  for (std::uint32_t k = 1; k <= sweeps; ++k) {
    ++unlooked_;
    const bool look = unlooked_ == rules_.window || k == sweeps;
    const bool forth = k % 2 == 1;
    const device::Buffer& from = forth ? rows.x : rows.product;
    const device::Buffer& to = forth ? rows.product : rows.x;
    const gpu::SweepPush push{
        rows.rows(),          rows.b.address(),          from.address(), to.address(),        rows.damping.address(),
        rows.state.address(), work_.reduction.address(), active,         look ? unlooked_ : 0};
    dispatch(work_.passes.of(shader::sweep, rows.model, rows.format), push, gate_of(level_), "sweep");
    if (!look) continue;
    record_surface(to, rows.surface_before, gpu::SURFACE_CHANGE);
    unlooked_ = 0;
  }
}

void LevelSolver::record(std::uint32_t iterations) {
  if (rules_.step == Step::sweep) return record_sweeps(iterations);
  for (std::uint32_t k = 0; k < iterations; ++k) {
    if (rules_.step == Step::cycle) {
      record_cycle();
    } else {
      record_cg();
    }
    if (++unlooked_ < rules_.window) continue;
    record_surface(op().x, op().surface_before, gpu::SURFACE_CHANGE);
    unlooked_ = 0;
  }
}

void LevelSolver::record_state() {
  work_.recorder.copy(op().state, op().state_on_host, sizeof(gpu::SolveState));
}

void LevelSolver::did(std::uint32_t iterations) {
  const OperatorBuffers& rows = op();
  Recorder& recorder = work_.recorder;
  const std::uint64_t field = rows.field_bytes() * rows.count;
  const double active = static_cast<double>(active_rows()) / rows.count;
  if (rules_.step == Step::sweep) {
    recorder.did("sweep", iterations,
                 static_cast<std::uint64_t>(active * static_cast<double>(rows.product_bytes() + 4 * field)));
  }
  if (rules_.step == Step::conjugate_gradients) {
    recorder.did("cg-multiply", iterations, rows.product_bytes() + 3 * field);
    recorder.did("cg-update", iterations, 7 * field);
    recorder.did("cg-direction", iterations, 4 * field);
  }
  if (rules_.step == Step::cycle) {
    recorder.did("correction", iterations, 3 * field);
    recorder.did("residual", iterations, start_bytes());
  }
  if (multigrid_) multigrid_->did(level_, iterations);
  recorder.did(
      "surface change", iterations / rules_.window,
      rows.surface_count * (rows.field_bytes() + sizeof(gpu::SurfaceShare) + 2 * std::uint64_t{sizeof(glm::vec3)}));
  entries_ += iterations * (active * rows.entries + (multigrid_ ? multigrid_->entries(level_) : 0.0));
}

void LevelSolver::take() {
  state_ = op().state_on_host.mapped_as<gpu::SolveState>()[0];
  const std::uint32_t all = state_.earlier + state_.iterations;
  did(all - taken_);
  taken_ = all;
  if (!failed() || rules_.cycles) return;
  throw SolverError("level " + std::to_string(level_) + ": " + std::string(name_of(key_.method)) + " (" +
                    std::string(name_of(key_.model)) + ") with " + std::string(name_of(task_.solver)) + " " +
                    failure());
}

bool LevelSolver::failed() const {
  return state_.status >= gpu::SOLVE_NOT_POSITIVE;
}

std::string LevelSolver::failure() const {
  const char* what = "stalls";
  if (state_.status == gpu::SOLVE_NOT_POSITIVE) {
    what =
        "met a direction of non-positive energy: the matrix is not positive definite in single precision; take "
        "coefficients of the material that lie closer together, or another solver";
  }
  if (state_.status == gpu::SOLVE_NOT_FINITE) what = "met a value that is not finite";
  if (state_.status == gpu::SOLVE_DIVERGED) what = "diverges";
  return std::string(what) + " (iteration " + std::to_string(state_.iterations) + ", channel " +
         std::to_string(state_.channel) + ")";
}

void LevelSolver::run() {
  record_start();
  do {
    record(std::min(rules_.batch, task_.max_iterations - state_.iterations));
    record_check();
    record_state();
    work_.recorder.submit();
    const std::uint32_t before = taken_;
    const float residual_before = state_.residual;
    take();
    if (rules_.step == Step::sweep && running() && before > 0 && state_.residual > least_progress * residual_before) {
      stagnated_ = true;
    }
    if (rules_.step == Step::sweep && (taken_ - before) % 2 == 1) {
      std::swap(operators_.at(key_, level_).x, operators_.at(key_, level_).product);
    }
  } while (running());
}

LevelReport LevelSolver::report() const {
  const std::optional<ErrorEstimate> left = algebraic();
  const bool met = task_.fixed && left && left->whole <= task_.tolerance && left->unlit <= task_.tolerance;
  return {.level = level_,
          .unknowns = op().count * (op().model == Model::sp3 ? 2 : 1),
          .iterations = taken_,
          .residual = state_.residual,
          .converged = task_.start ? !failed() : state_.status == gpu::SOLVE_CONVERGED || met};
}

ErrorEstimate LevelSolver::difference() const {
  return by_part(state_.difference);
}

std::optional<ErrorEstimate> LevelSolver::algebraic() const {
  if (state_.algebraic.x < 0) return std::nullopt;
  return by_part(state_.algebraic);
}

}  // namespace quadgraph
