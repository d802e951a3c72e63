// One solve: from coefficients and light over all levels, coarsest first, with the bounces on their level, to what
// leaves the surface. Solvers with cycles take one submission, unless what they are asked for needs more cycles or
// bounces than that holds; the others look at the state of every level from the host.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/reference/resolution.h"
#include "engine/solve/coefficients.h"
#include "engine/solve/inter_reflection.h"
#include "engine/solve/level_solver.h"
#include "engine/solve/operators.h"
#include "engine/solve/source_walk.h"
#include "engine/solve/surface_results.h"

namespace quadgraph {

// What a solve works with; all of it outlives the solve.
struct SolveParts {
  Workspace& work;
  const std::vector<LevelBuffers>& levels;
  const BeamBuffers& beams;
  std::vector<SourceWalk>& walks;  // one per level
  Operators& operators;
  SurfaceResults& results;
  Coefficients& coefficients;
  Refractions& refractions;
  InterReflection& exchange;
  bool& scaled;  // the scale is that of the present q
  // What elements resolve, per level, which may take a while the first time; null where nothing is known of it.
  std::function<std::span<const Resolution>()> resolution;
};

class LevelsSolver {
 public:
  // The operators of `key` have been created. `solver` instead of that of the options, never automatic.
  LevelsSolver(const SolveParts& parts, const OperatorKey& key, const SolveOptions& options, SolverKind solver);

  // Throws as Simulation::solve.
  SolveReport run();

 private:
  OperatorBuffers& op(std::uint32_t level) { return parts_.operators.at(key_, level); }
  bool bounces_reach(std::uint32_t level) const;
  bool bounces_on(std::uint32_t level) const;
  bool cycles() const { return rules_of(report_.solver).cycles; }
  Solved solved(std::uint32_t level);
  WalkTask walk_task() const;
  Energy energy() const;
  double unbalanced() const;
  double algebraic_wanted() const;
  bool balanced() const;

  void start_over();
  void record_setup(std::uint32_t level);
  void record_load(std::uint32_t level);
  void record_load_again(std::uint32_t level);
  void record_light(std::uint32_t level);
  void record_first(std::uint32_t level);
  void record_solved(std::uint32_t level);
  void record_difference(std::uint32_t level);
  void set_solver(std::uint32_t level);
  void approach(std::uint32_t level);
  void iterate(std::uint32_t level);
  void solve(std::uint32_t level);
  void solve_down_to(std::uint32_t finest);
  bool bounced_enough() const;
  bool reached() const;
  bool stopped_short() const;
  void bounce(std::uint32_t bounces);
  void bounce_more();
  void settle();
  void replace();
  void record_results();
  void submit();
  void take_error();
  void finish();

  SolveParts parts_;
  OperatorKey key_;
  const SolveOptions& options_;
  const BodyBoundaries& boundaries_;
  SolveReport report_;
  std::uint32_t finest_ = 0;  // level that is solved last, as far as is known
  std::uint32_t next_ = 0;    // level to be solved next; all coarser ones have been
  bool warm_ = false;
  std::uint32_t rounds_ = 0;                         // of iterations that were added because light was unaccounted for
  std::vector<std::optional<LevelSolver>> solvers_;  // per level
};

}  // namespace quadgraph
