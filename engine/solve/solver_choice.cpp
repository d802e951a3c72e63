#include "engine/solve/solver_choice.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "engine/base/error.h"
#include "engine/solve/level_solver.h"
#include "engine/solve/multigrid.h"

namespace quadgraph {
namespace {

// Passes that one solver has and the other has not, or more often.
double solver_ms(const std::vector<PassStats>& passes) {
  constexpr std::array names = {"residual",     "cg-multiply",     "cg-update",   "cg-direction",
                                "smoothing",    "coarse residual", "restriction", "coarse solve",
                                "prolongation", "surface change",  "transfer",    "eigenvalue bound"};
  double spent = 0;
  for (const PassStats& pass : passes) {
    if (std::find(names.begin(), names.end(), pass.name) != names.end()) spent += pass.time_ms;
  }
  return spent;
}

// A ratio as text, with two digits after the point.
std::string ratio_text(double ratio) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f", ratio);
  return text;
}

}  // namespace

PossibleSolver possible_solver(Operators& operators, const OperatorKey& key, SolverKind wanted) {
  const std::string method(name_of(key.method)), name(name_of(wanted));
  const SolverRules rules = rules_of(wanted);
  if (!symmetric(key.method)) {
    if (rules.any_matrix) return {wanted, ""};
    if (!rules.cycles) {
      throw InputError("solver " + name + ": the matrix of " + method +
                       " is not symmetric; cascade and jacobi take it");
    }
    return {SolverKind::cascade, name + " by cascade: the matrix of " + method + " is not symmetric"};
  }
  if (!rules.cycles || Multigrid::possible(operators, key)) return {wanted, ""};
  const std::string why =
      key.method == Method::fem ? "there is no coarser level that is small enough" : method + " has no cycles";
  return {SolverKind::dpcg, name + " by dpcg: " + why};
}

SolveReport SolverChoice::solve(const OperatorKey& key, const SolveOptions& options, bool cycles,
                                const std::function<SolveReport(SolverKind)>& run,
                                const std::function<std::vector<PassStats>()>& passes) {
  if (!cycles) return run(symmetric(key.method) ? SolverKind::dpcg : SolverKind::cascade);
  const auto found = quicker_.find(key);
  if (found != quicker_.end()) return run(found->second);
  if (options.warm || options.cycles > 0 || options.error > 0) return run(SolverKind::fmg_pcg);
  const SolveReport first = run(SolverKind::fmg_pcg);
  const double cycles_ms = solver_ms(passes());
  if (!first.replaced.empty()) {
    quicker_[key] = SolverKind::dpcg;
    return first;
  }
  SolveReport report = run(SolverKind::dpcg);
  const double dpcg_ms = solver_ms(passes()) - cycles_ms;
  quicker_[key] = dpcg_ms < cycles_ms ? SolverKind::dpcg : SolverKind::fmg_pcg;
  report.replaced = "auto: both tried, " + std::string(name_of(quicker_[key])) + " from now on: dpcg took " +
                    ratio_text(dpcg_ms / cycles_ms) + " of the time of fmg-pcg";
  return report;
}

}  // namespace quadgraph
