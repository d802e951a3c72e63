#include "engine/solve/level_solver.h"

#include <algorithm>
#include <cstddef>

#include "engine/graph/error.h"

namespace quadgraph {
namespace {

// Iterations recorded between two looks at the state. After convergence the rest of a batch dispatches nothing.
constexpr std::uint32_t batch = 32;

// Sweeps between two residual checks on the device; even, so that a relaxation stops with the result in x.
constexpr std::uint32_t sweeps_per_check = 8;
constexpr std::uint32_t sweep_batch = 64;

// A batch of sweeps that lowers the residual by less than this share of it has met the limit of single precision.
constexpr double least_progress = 1e-4;

class LevelSolver {
 public:
  LevelSolver(Workspace& work, OperatorBuffers& op, std::uint32_t level, const SolveOptions& options)
      : work_(work), op_(op), level_(level), options_(options), tolerance_(static_cast<float>(options.tolerance)) {}

  LevelReport run() {
    record_start(true);
    const bool cascade = options_.solver == SolverKind::cascade;
    if (cascade) {
      read_state();
      relax();
    } else {
      conjugate_gradients();
    }
    throw_on_failure();
    return {.level = level_,
            .unknowns = op_.count * (op_.model == Model::sp3 ? 2 : 1),
            .iterations = state_.iterations,
            .residual = state_.residual,
            .converged = state_.status == gpu::SOLVE_CONVERGED};
  }

 private:
  void record_start(bool first) {
    const gpu::CgStartPush push{
        op_.rows(),          op_.b.address(),           op_.x.address(), op_.r.address(),         op_.p.address(),
        op_.state.address(), work_.reduction.address(), op_.count,       options_.max_iterations, tolerance_,
        first ? 1u : 0u};
    if (first) {
      work_.recorder.dispatch(work_.passes.cg_start.of(op_.model), push, op_.count, "residual", start_bytes());
    } else {
      work_.recorder.dispatch_indirect(work_.passes.cg_start.of(op_.model), push, op_.state,
                                       offsetof(gpu::SolveState, check), "residual");
    }
  }

  std::uint64_t start_bytes() const { return op_.product_bytes() + 5 * op_.field_bytes() * op_.count; }

  void read_state() {
    work_.recorder.copy(op_.state, work_.state_on_host, sizeof(gpu::SolveState));
    work_.recorder.submit();
    state_ = work_.state_on_host.mapped_as<gpu::SolveState>()[0];
  }

  bool running() const { return state_.status == gpu::SOLVE_RUNNING; }

  void record_iteration() {
    const gpu::CgMultiplyPush multiply{op_.rows(),          op_.p.address(),           op_.product.address(),
                                       op_.state.address(), work_.reduction.address(), op_.count,
                                       tolerance_};
    const gpu::CgUpdatePush update{
        op_.diagonal.address(),  op_.p.address(),     op_.product.address(),     op_.x.address(),
        op_.r.address(),         op_.state.address(), work_.reduction.address(), op_.count,
        options_.max_iterations, tolerance_};
    const gpu::CgDirectionPush direction{op_.diagonal.address(), op_.r.address(), op_.p.address(), op_.state.address(),
                                         op_.count};
    constexpr std::uint64_t offset = offsetof(gpu::SolveState, iterate);
    work_.recorder.dispatch_indirect(work_.passes.cg_multiply.of(op_.model), multiply, op_.state, offset,
                                     "cg-multiply");
    work_.recorder.dispatch_indirect(work_.passes.cg_update.of(op_.model), update, op_.state, offset, "cg-update");
    work_.recorder.dispatch_indirect(work_.passes.cg_direction.of(op_.model), direction, op_.state, offset,
                                     "cg-direction");
  }

  void conjugate_gradients() {
    do {
      const std::uint32_t before = state_.iterations;
      for (std::uint32_t i = 0; i < batch; ++i) record_iteration();
      record_start(false);
      read_state();
      const std::uint32_t done = state_.iterations - before;
      work_.recorder.did("cg-multiply", done, op_.product_bytes() + 3 * op_.field_bytes() * op_.count);
      work_.recorder.did("cg-update", done, 7 * op_.field_bytes() * op_.count);
      work_.recorder.did("cg-direction", done, 4 * op_.field_bytes() * op_.count);
      if (!running() && done > 0) work_.recorder.did("residual", 1, start_bytes());
    } while (running());
  }

  void record_sweep(const vk::Buffer& from, const vk::Buffer& to, std::uint32_t sweeps) {
    const gpu::SweepPush push{
        op_.rows(),          op_.b.address(),           from.address(), to.address(), op_.damping.address(),
        op_.state.address(), work_.reduction.address(), op_.count,      sweeps,       tolerance_};
    work_.recorder.dispatch_indirect(work_.passes.sweep.of(op_.model), push, op_.state,
                                     offsetof(gpu::SolveState, iterate), "sweep");
  }

  void relax() {
    while (running()) {
      const std::uint32_t before = state_.iterations;
      const double residual_before = state_.residual;
      const std::uint32_t sweeps = std::min(sweep_batch, options_.max_iterations - before);
      std::uint32_t unchecked = 0;
      for (std::uint32_t k = 1; k <= sweeps; ++k) {
        ++unchecked;
        const bool check = unchecked == sweeps_per_check || k == sweeps;
        const bool forth = k % 2 == 1;
        record_sweep(forth ? op_.x : op_.product, forth ? op_.product : op_.x, check ? unchecked : 0);
        if (check) unchecked = 0;
      }
      read_state();
      const std::uint32_t done = state_.iterations - before;
      if (done % 2 == 1) std::swap(op_.x, op_.product);
      work_.recorder.did("sweep", done, op_.product_bytes() + 4 * op_.field_bytes() * op_.count);
      if (!running()) return;
      if (state_.iterations >= options_.max_iterations) {
        state_.status = gpu::SOLVE_EXHAUSTED;
      } else if (state_.residual > (1 - least_progress) * residual_before) {
        state_.status = gpu::SOLVE_STAGNATED;
      }
    }
  }

  void throw_on_failure() const {
    const char* what = nullptr;
    if (state_.status == gpu::SOLVE_NOT_POSITIVE)
      what =
          "met a direction of non-positive energy: the matrix is not "
          "positive definite";
    if (state_.status == gpu::SOLVE_NOT_FINITE) what = "met a value that is not finite";
    if (state_.status == gpu::SOLVE_DIVERGED) what = "diverges";
    if (what == nullptr) return;
    throw SolverError("level " + std::to_string(level_) + ": " + std::string(name_of(options_.method)) + " (" +
                      std::string(name_of(op_.model)) + ") with " + std::string(name_of(options_.solver)) + " " + what +
                      " (iteration " + std::to_string(state_.iterations) + ", channel " +
                      std::to_string(state_.channel) + ")");
  }

  Workspace& work_;
  OperatorBuffers& op_;
  std::uint32_t level_;
  const SolveOptions& options_;
  float tolerance_;
  gpu::SolveState state_{};
};

}  // namespace

LevelReport solve_level(Workspace& work, OperatorBuffers& op, std::uint32_t level, const SolveOptions& options) {
  return LevelSolver(work, op, level, options).run();
}

}  // namespace quadgraph
