#include "engine/solve/level_solver.h"

#include <algorithm>
#include <cstddef>

#include "engine/base/error.h"
#include "engine/solve/assembly.h"
#include "shaders/surface/surface_shared.h"

namespace quadgraph {
namespace {

// Iterations between two looks at the surface. A relaxation's number is even, so that what is looked at is in x.
std::uint32_t window_of(SolverKind solver) {
  return uses_cycles(solver) ? 1 : 8;
}

// Iterations in one submission where the host decides whether to go on.
std::uint32_t batch_of(SolverKind solver) {
  if (uses_cycles(solver)) return 8;
  return solver == SolverKind::dpcg ? 32 : 64;
}

// Tolerances below this are close to what single precision gives: the true residual has the last word.
constexpr double tight = 1e-4;

// How a solver's looks at the surface become an estimate of what is left, and when it counts as stalled. Measured on
// bunnies and thin bodies, six materials, both models: healthy cycles have rates of .15 to .5.
struct Looks {
  std::uint32_t first;  // look from which the estimate counts
  float least_rate;
  std::uint32_t stall_limit;
  float slow_rate;
};

Looks looks_of(SolverKind solver) {
  switch (solver) {
    case SolverKind::fmg_pcg:
      return {1, 0.1f, 3, 0.7f};
    case SolverKind::vcycle:
      return {1, 0.1f, 2, 0.9f};
    case SolverKind::dpcg:
      return {2, 0.25f, 0, 1.0f};
    default:
      return {3, 0.1f, 0, 1.0f};
  }
}

// A batch of sweeps that leaves more of the residual than this has met the limit of single precision.
constexpr float least_progress = 1 - 1e-4f;

bool relaxes(SolverKind solver) {
  return solver == SolverKind::cascade || solver == SolverKind::jacobi;
}

std::uint64_t gate_of(std::uint32_t level) {
  return offsetof(gpu::SolveState, gate) + level * sizeof(glm::uvec3);
}

}  // namespace

bool uses_cycles(SolverKind solver) {
  return solver == SolverKind::fmg_pcg || solver == SolverKind::vcycle;
}

LevelSolver::LevelSolver(Workspace& work, Operators& operators, const OperatorKey& key, std::uint32_t level,
                         const LevelTask& task)
    : work_(work), operators_(operators), key_(key), level_(level), task_(task) {
  if (uses_cycles(task.solver)) multigrid_.emplace(work, operators, key, task.smoothing);
}

template <typename Push>
void LevelSolver::dispatch(LazyPass& pass, const Push& push, std::uint64_t gate, const char* name, bool concludes) {
  work_.recorder.dispatch_indirect(pass, push, op().state, gate, name, concludes);
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
    work_.recorder.dispatch(work_.passes.cg_start.of(rows.model, rows.format), push, rows.count, "residual",
                            start_bytes());
  } else {
    const std::uint64_t gate = what == gpu::START_CHECK ? offsetof(gpu::SolveState, check) : gate_of(level_);
    dispatch(work_.passes.cg_start.of(rows.model, rows.format), push, gate, "residual");
  }
}

void LevelSolver::record_surface(const vk::Buffer& x, const vk::Buffer& before, std::uint32_t what) {
  const OperatorBuffers& rows = op();
  const Looks looks = looks_of(task_.solver);
  const gpu::SurfaceChangePush push{.x = x.address(),
                                    .to_phi = rows.to_phi.address(),
                                    .share = rows.surface_share.address(),
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
                                    .by_change = relaxes(task_.solver) ? 1u : 0u,
                                    .least_rate = looks.least_rate,
                                    .slow_rate = looks.slow_rate,
                                    // Far from the surface a jump of kappa can hide errors from it for long.
                                    .by_residual = task_.solver == SolverKind::dpcg ? 1u : 0u,
                                    .tolerance = task_.fixed ? 0.0f : static_cast<float>(task_.tolerance),
                                    .boundary = on_device(task_.boundary)};
  const std::uint64_t bytes =
      rows.surface_count * (rows.field_bytes() + sizeof(gpu::SurfaceShare) + 2 * std::uint64_t{sizeof(glm::vec3)});
  if (what == gpu::SURFACE_CHANGE) {
    dispatch(work_.passes.surface_change.of(key_.model), push, offsetof(gpu::SolveState, surface), "surface change");
  } else {
    work_.recorder.dispatch(work_.passes.surface_change.of(key_.model), push, rows.surface_count, "surface change",
                            bytes, what != gpu::SURFACE_STORE);
  }
}

void LevelSolver::record_origin(const vk::Buffer& x) {
  record_surface(x, op().surface_start, gpu::SURFACE_STORE);
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
  const vk::Buffer& z = multigrid_ ? multigrid_->correction(level_) : rows.z;
  const gpu::CgDirectionPush direction{rows.rows().diagonal, rows.r.address(), z.address(), rows.p.address(),
                                       rows.state.address(), rows.count,       multigrid};
  // The first direction of plain conjugate gradients comes with the start.
  if (multigrid_) {
    multigrid_->record(level_);
    dispatch(work_.passes.cg_direction.of(rows.model, rows.format), direction, gate_of(level_), "cg-direction");
  }
  dispatch(work_.passes.cg_multiply.of(rows.model, rows.format), multiply, gate_of(level_), "cg-multiply");
  dispatch(work_.passes.cg_update.of(rows.model, rows.format), update, gate_of(level_), "cg-update");
  if (!multigrid_)
    dispatch(work_.passes.cg_direction.of(rows.model, rows.format), direction, gate_of(level_), "cg-direction");
}

// x += z, then the residual anew.
void LevelSolver::record_cycle() {
  const OperatorBuffers& rows = op();
  multigrid_->record(level_);
  const gpu::CorrectPush correct{multigrid_->correction(level_).address(), rows.x.address(), rows.state.address(),
                                 rows.count};
  dispatch(work_.passes.correct.of(key_.model), correct, gate_of(level_), "correction");
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
    const bool look = unlooked_ == window_of(task_.solver) || k == sweeps;
    const bool forth = k % 2 == 1;
    const vk::Buffer& from = forth ? rows.x : rows.product;
    const vk::Buffer& to = forth ? rows.product : rows.x;
    const gpu::SweepPush push{
        rows.rows(),          rows.b.address(),          from.address(), to.address(),        rows.damping.address(),
        rows.state.address(), work_.reduction.address(), active,         look ? unlooked_ : 0};
    dispatch(work_.passes.sweep.of(rows.model, rows.format), push, gate_of(level_), "sweep", look);
    if (!look) continue;
    record_surface(to, rows.surface_before, gpu::SURFACE_CHANGE);
    unlooked_ = 0;
  }
}

void LevelSolver::record(std::uint32_t iterations) {
  if (relaxes(task_.solver)) return record_sweeps(iterations);
  for (std::uint32_t k = 0; k < iterations; ++k) {
    if (task_.solver == SolverKind::vcycle) {
      record_cycle();
    } else {
      record_cg();
    }
    if (++unlooked_ < window_of(task_.solver)) continue;
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
  if (relaxes(task_.solver)) {
    recorder.did("sweep", iterations,
                 static_cast<std::uint64_t>(active * static_cast<double>(rows.product_bytes() + 4 * field)));
  }
  if (task_.solver == SolverKind::fmg_pcg || task_.solver == SolverKind::dpcg) {
    recorder.did("cg-multiply", iterations, rows.product_bytes() + 3 * field);
    recorder.did("cg-update", iterations, 7 * field);
    recorder.did("cg-direction", iterations, 4 * field);
  }
  if (task_.solver == SolverKind::vcycle) {
    recorder.did("correction", iterations, 3 * field);
    recorder.did("residual", iterations, start_bytes());
  }
  if (multigrid_) multigrid_->did(level_, iterations);
  recorder.did(
      "surface change", iterations / window_of(task_.solver),
      rows.surface_count * (rows.field_bytes() + sizeof(gpu::SurfaceShare) + 2 * std::uint64_t{sizeof(glm::vec3)}));
  entries_ += iterations * (active * rows.entries + (multigrid_ ? multigrid_->entries(level_) : 0.0));
}

void LevelSolver::take() {
  state_ = op().state_on_host.mapped_as<gpu::SolveState>()[0];
  const std::uint32_t all = state_.earlier + state_.iterations;
  did(all - taken_);
  taken_ = all;
  if (!failed() || uses_cycles(task_.solver)) return;
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
    what = "met a direction of non-positive energy: the matrix is not positive definite";
  }
  if (state_.status == gpu::SOLVE_NOT_FINITE) what = "met a value that is not finite";
  if (state_.status == gpu::SOLVE_DIVERGED) what = "diverges";
  return std::string(what) + " (iteration " + std::to_string(state_.iterations) + ", channel " +
         std::to_string(state_.channel) + ")";
}

void LevelSolver::run() {
  record_start();
  do {
    record(std::min(batch_of(task_.solver), task_.max_iterations - state_.iterations));
    record_check();
    record_state();
    work_.recorder.submit();
    const std::uint32_t before = taken_;
    const float residual_before = state_.residual;
    take();
    if (relaxes(task_.solver) && running() && before > 0 && state_.residual > least_progress * residual_before) {
      stagnated_ = true;
    }
    if (relaxes(task_.solver) && (taken_ - before) % 2 == 1) {
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

std::optional<ErrorEstimate> LevelSolver::algebraic() const {
  if (state_.algebraic.x < 0 || state_.algebraic.y < 0) return std::nullopt;
  return ErrorEstimate{state_.algebraic.x, state_.algebraic.y};
}

}  // namespace quadgraph
