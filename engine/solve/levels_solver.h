// One solve: from coefficients and light over all levels, coarsest first, with the bounces on their level, to what
// leaves the surface of the finest.
#pragma once

#include <vector>

#include "engine/solve/coefficients.h"
#include "engine/solve/inter_reflection.h"
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
  InterReflection& exchange;
  bool& scaled;  // the scale is that of the present q
};

class LevelsSolver {
 public:
  // The operators of `key` have been created.
  LevelsSolver(const SolveParts& parts, const OperatorKey& key, const SolveOptions& options);

  // Throws as Simulation::solve.
  SolveReport run();

 private:
  OperatorBuffers& op(std::uint32_t level) { return parts_.operators.at(key_, level); }
  Solved solved(std::uint32_t level);
  Energy energy() const;
  void record_load(std::uint32_t level);
  void record_load_again(std::uint32_t level);
  void record_setup();
  void solve_levels();
  void solve(std::uint32_t level);
  void bounce();
  void finish();

  SolveParts parts_;
  OperatorKey key_;
  const SolveOptions& options_;
  Boundary boundary_;
  SolveReport report_;
};

}  // namespace quadgraph
