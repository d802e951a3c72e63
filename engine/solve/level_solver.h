// Solves one level on the device from the x it holds: records the passes of any solver, each behind a gate that closes
// on the device once the surface has met the tolerance, so that a whole solve fits in one submission.
#pragma once

#include <optional>

#include "engine/reference/solution.h"
#include "engine/solve/assembly.h"
#include "engine/solve/multigrid.h"
#include "engine/solve/operators.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

// What a solve of one level is to do.
struct LevelTask {
  SolverKind solver = SolverKind::fmg_pcg;  // never automatic; in one with cycles, the level may be any
  std::uint64_t boundaries = 0;             // address of BodyBoundaries::on_device
  double tolerance = 1e-3;                  // of the algebraic error
  bool fixed = false;                       // max_iterations are done whatever is left
  bool start = false;                       // only to start the next finer level: never too little
  std::uint32_t max_iterations = 0;         // in all
  std::uint32_t smoothing = 1;              // of a cycle
  std::uint32_t active_layers = 0;          // of a relaxation: rows below these layers stay as they are; 0: none do
};

// How a solver's looks at the surface become an estimate of what is left, and when it counts as stalled.
struct SolverLooks {
  std::uint32_t first;  // look from which the estimate counts
  float least_rate;
  std::uint32_t stall_limit;
  float slow_rate;
};

// What makes a kind of solver: all that the rest of the engine asks of it.
struct SolverRules {
  enum class Step { conjugate_gradients, cycle, sweep } step;
  bool cycles = false;      // it needs coarser levels and a symmetric matrix
  bool any_matrix = false;  // it takes one that is not symmetric
  bool alone = false;       // it starts from nothing on the finest level, else from the coarsest level on
  StepBound bound = StepBound::damping;
  std::uint32_t smoothing = 1;  // steps that are cheapest for it
  std::uint32_t window;  // iterations between two looks at the surface; of sweeps an even number, as x is then last
  std::uint32_t batch;   // iterations in one submission where the host decides whether to go on
  SolverLooks looks;
};

// The rules of a solver; for SolverKind::automatic those of its first choice.
SolverRules rules_of(SolverKind solver);

class LevelSolver {
 public:
  // The operators of `key` have been created; rows, b and its norm are in place when what is recorded runs.
  LevelSolver(Workspace& work, Operators& operators, const OperatorKey& key, std::uint32_t level,
              const LevelTask& task);

  // Notes the exitance of `x` as that of the start, for record_difference.
  void record_origin(const device::Buffer& x);

  // One step of the smoother on an x that was interpolated; of solvers with cycles.
  void record_relaxation();

  // The residual of x, and the gates.
  void record_start();

  // `iterations` more, looking at the surface every so often.
  void record(std::uint32_t iterations);

  // Where the surface has met a tight tolerance: does the true residual agree?
  void record_check();

  // The difference of the exitance from that of the start.
  void record_difference();

  // To be read by `take` after the next submission.
  void record_state();

  // Adds what has been done since the last call to the passes' counts. Throws SolverError naming level, iteration and
  // channel where conjugate gradients or a relaxation break down.
  void take();

  // The state that the last `take` read.
  const gpu::SolveState& state() const { return state_; }
  bool running() const {
    return state_.status == gpu::SOLVE_RUNNING && !stagnated_ && state_.iterations < task_.max_iterations;
  }

  // Cycles that stall or grow, or meet what is not a number.
  bool failed() const;
  std::string failure() const;

  std::uint32_t max_iterations() const { return task_.max_iterations; }

  // Start, iterations in batches, to the end.
  void run();

  LevelReport report() const;
  std::optional<ErrorEstimate> algebraic() const;

  // From the exitance of the start, as record_difference found it.
  ErrorEstimate difference() const;

  // Entries multiplied so far, as far as `take` knows.
  double entries() const { return entries_; }

 private:
  using Step = SolverRules::Step;

  std::uint32_t active_rows() const;
  const OperatorBuffers& op() const { return operators_.at(key_, level_); }
  template <typename Push>
  void dispatch(LazyPass& pass, const Push& push, std::uint64_t gate, const char* name);
  void dispatch_start(std::uint32_t what);
  void record_surface(const device::Buffer& x, const device::Buffer& before, std::uint32_t what);
  void record_cg();
  void record_cycle();
  void record_sweeps(std::uint32_t sweeps);
  bool verified() const;
  void did(std::uint32_t iterations);
  std::uint64_t start_bytes() const;

  Workspace& work_;
  Operators& operators_;
  OperatorKey key_;
  std::uint32_t level_;
  LevelTask task_;
  SolverRules rules_;
  std::optional<Multigrid> multigrid_;
  std::uint32_t unlooked_ = 0;  // iterations recorded since the last look at the surface
  std::uint32_t taken_ = 0;     // iterations counted, over all starts
  bool started_ = false;
  double entries_ = 0;
  bool stagnated_ = false;  // a relaxation that single precision lets fall no further
  gpu::SolveState state_{};
};

}  // namespace quadgraph
