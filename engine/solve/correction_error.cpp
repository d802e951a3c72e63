#include "engine/solve/correction_error.h"

#include <algorithm>
#include <cmath>

namespace quadgraph {
namespace {

// Of what a sweep has changed, the share that all further ones would: the first leaves a smaller one than the others,
// but of light that meets the body again it knows little more than the solve.
constexpr double left_by_first = 0.13, left_by_next = 0.3;

// So much more where sweeps settle slowly (Resolution::slow), of each.
constexpr double slow_first = 0.8, slow_next = 0.5;

// Of the solver's error the same. Of the mesh's the share that is left, and what no two levels tell apart: the light
// and the medium as faces and tets have them.
constexpr double solver_left = left_by_first, mesh_left = 0.15, unseen = 0.004;

// So many times the mesh's error more is left where it is large, because tets cannot hold what the sweeps find. Of the
// whole surface, and of the dimmest third, whose levels differ by as much as it has, there is no sign of that.
constexpr ErrorEstimate mesh_left_more{.whole = 0, .unlit = 0.8, .dimmest = 0};

// And so much more of its share, times Resolution::slow: in elements of many mean free paths sweeps cannot mend what
// these make of the terminator.
constexpr ErrorEstimate mesh_left_slow{.whole = 0, .unlit = 0.3, .dimmest = 0};

// The halves share what their points see of the body; so much more than they differ by is the noise.
constexpr double noise_over_difference = 1.2;

// Means over few patches are badly known: change and noise are no less than this share of those at vertices. Measured
// are .3 to .9 (docs/physics.md, "Transport correction").
constexpr double least_of_patches = 0.25;

// Of the square of the noise, what the product of two halves without any change can come to on a body with few
// independent parts.
constexpr double by_chance = 0.25;

}  // namespace

double share_left_by(const CorrectionReport& done) {
  if (done.goes_on || done.sweeps.size() > 1) return left_by_next + slow_next * done.slow;
  return left_by_first + done.returns + slow_first * done.slow;
}

ErrorEstimate share_taken(const CorrectionReport& done, std::uint32_t mean_of) {
  const auto share = [&](double change, double noise) {
    const double all = noise * noise / std::max(mean_of, 1u), known = std::max(0.0, change * change - by_chance * all);
    return noise > 0 ? known / (known + all) : 1;
  };
  ErrorEstimate taken = by_parts(share, done.changed, done.sweeps.back().noise);
  taken.unlit = std::max(taken.unlit, taken.dimmest);
  if (done.patches) taken.unlit = std::max(taken.unlit, share(done.patches->change.unlit, done.patches->noise.unlit));
  taken.dimmest = taken.unlit;
  return taken;
}

void take_patches(CorrectionReport& done, const CorrectedPatches& patches, const SolveOptions& options) {
  const auto bounded = [](double of_patches, double of_vertices) {
    return std::max(of_patches, least_of_patches * of_vertices);
  };
  done.patches = {by_parts(bounded, patches.change, done.changed),
                  by_parts(bounded, patches.noise, done.sweeps.back().noise)};
  if (options.sweeps == 0 || options.mean_of > 0) done.taken = share_taken(done, options.mean_of);
}

ErrorEstimate left_by_sweeps(const CorrectionReport& done) {
  const double share = noise_over_difference * share_left_by(done);
  return by_parts([&](double change) { return share * change; }, done.sweeps.back().change);
}

ErrorEstimate noise_of(const CorrectionReport& done, std::uint32_t mean_of) {
  const double share = noise_over_difference / std::sqrt(static_cast<double>(std::max(mean_of, 1u)));
  const ErrorEstimate& noise = done.patches ? done.patches->noise : done.sweeps.back().noise;
  return by_parts([&](double own, double taken) { return share * taken * own; }, noise, done.taken);
}

void state_corrected_error(SolveReport& report, double unresolved, std::uint32_t mean_of) {
  const CorrectionReport& done = *report.correction;
  const CorrectedSweep& last = done.sweeps.back();
  const auto of_model = [](double left, double noise, double all, double taken) {
    return std::hypot(left, noise, noise_over_difference * (1 - taken) * all);
  };
  const ErrorEstimate& change = done.patches ? done.patches->change : done.changed;
  report.model_error = by_parts(of_model, left_by_sweeps(done), noise_of(done, mean_of), change, done.taken);
  if (report.algebraic) {
    report.algebraic = by_parts([](double part) { return solver_left * part; }, *report.algebraic);
  }
  report.error.reset();
  if (!report.mesh_error) return;
  const auto of_mesh = [&](double part, double noise, double more, double slow) {
    const double left = std::min(1.0, std::hypot(mesh_left + slow * done.slow, more * part));
    return noise > 0 ? std::hypot(left * part, unseen, unresolved) : 0;
  };
  report.mesh_error = by_parts(of_mesh, *report.mesh_error, last.noise, mesh_left_more, mesh_left_slow);
  const auto all = [](double a, double b, double c) { return std::sqrt(a * a + b * b + c * c); };
  const ErrorEstimate solver = report.algebraic.value_or(ErrorEstimate{});
  report.error = by_parts(all, *report.model_error, *report.mesh_error, solver);
}

}  // namespace quadgraph
