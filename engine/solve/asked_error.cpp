#include "engine/solve/asked_error.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/solve/mesh_error.h"

namespace quadgraph {
namespace {

// Share of the light that enters which sums in single precision may lose.
constexpr double lost_in_sums = 2e-6;

}  // namespace

double unbalanced(const Energy& energy, const Energy& collided) {
  double squares = 0, sizes = 0;
  for (int c = 0; c < 3; ++c) {
    const double out = energy.scattered_out[c], size = out + collided.absorbed[c];
    if (!(size > 0)) continue;
    const double share = std::max(0.0, std::abs(energy.balance()[c]) - lost_in_sums) * energy.entered[c] / size;
    squares += share * share * out * out;
    sizes += out * out;
  }
  return sizes > 0 ? std::sqrt(squares / sizes) : 0;
}

bool certain(const ErrorEstimate& estimate, double wanted) {
  return estimate.whole <= wanted / confidence && estimate.unlit <= wanted / confidence;
}

std::string missed(const std::optional<ErrorEstimate>& estimate, double wanted) {
  const std::string asked = "error " + percent_text(wanted);
  if (!estimate) return asked + ": a file with a single level cannot tell its error";
  return asked + " is not certain: the estimate is " + percent_text(estimate->whole) + " of the surface, " +
         percent_text(estimate->unlit) + " of its unlit part, and the error may be " + number_text(confidence) +
         " times that; a file with more vertices on its surface would come closer";
}

void state_missed(SolveReport& report, double wanted) {
  const bool kept = report.error && certain(*report.error, wanted);
  report.missed = wanted > 0 && !kept ? missed(report.error, wanted) : "";
}

std::string advice(const SolveReport& report) {
  constexpr double large = 0.05;
  const auto most = [](const std::optional<ErrorEstimate>& part) {
    return part ? std::max(part->whole, part->unlit) : 0.0;
  };
  if (most(report.error) <= large) return "";
  const double mesh = most(report.mesh_error), solver = most(report.algebraic), model = most(report.model_error);
  const double light = most(report.light_error), phase = most(report.phase_error);
  const std::string off = "the error is stated as " + percent_text(most(report.error)) + ", most of it ";
  if (report.carried && model >= std::max(mesh, solver)) {
    return off + "what a correction of another light or material leaves: at rest it is made anew";
  }
  if (!report.correction && !report.carried && mesh >= solver)
    return off + "the mesh's: a correction would take most of that away";
  if (phase > std::max({mesh, solver, model, light})) {
    return off + "that of scattering forwards, of which sweeps know two moments alone: no option brings it down";
  }
  if (light > std::max({mesh, solver, model})) {
    return off + "the light's: fewer lights have finer shadow maps";
  }
  if (solver > std::max(mesh, model)) return off + "the solver's: a smaller --tolerance brings it down";
  if (mesh > model) return off + "the mesh's: a file with more vertices has less";
  const CorrectedSweep& last = report.correction->sweeps.back();
  if (most(last.noise) > 0.7 * model) return off + "noise of the correction: more --sweep-points bring it down";
  return off + "what another sweep would change: more --sweeps bring it down";
}

void state_anew(SolveReport& report, double wanted) {
  state_missed(report, wanted);
  report.advice = advice(report);
}

std::string stopped(const LevelReport& level) {
  char residual[32];
  std::snprintf(residual, sizeof(residual), "%.2e", level.residual);
  return "not converged: level " + std::to_string(level.level) + " stopped after " + std::to_string(level.iterations) +
         " iterations at residual " + residual;
}

}  // namespace quadgraph
