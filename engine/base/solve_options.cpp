#include "engine/base/solve_options.h"

#include <string>

#include "engine/base/error.h"

namespace quadgraph {

void check_options(const SolveOptions& options) {
  if (!tolerance_range.contains(options.tolerance)) {
    throw InputError("tolerance: " + std::to_string(options.tolerance) + ", a number between 0 and 1 is wanted");
  }
  if (!error_range.contains(options.error)) {
    throw InputError("error: " + std::to_string(options.error) + ", a number from 0 (no target) to below 1 is wanted");
  }
  if (options.active_layers > 0 && !on_grid(options.method)) {
    throw InputError("active_layers: " + std::to_string(options.active_layers) + " with method " +
                     std::string(name_of(options.method)) + ", which has no layers: allowed is 0");
  }
  if (options.smoothing > 2) {
    throw InputError("smoothing: " + std::to_string(options.smoothing) +
                     " steps, allowed are 1 and 2, and 0 for either");
  }
  if (options.sweeps > 0 && !options.correction) {
    throw InputError("sweeps: " + std::to_string(options.sweeps) + " without correction, allowed is 0");
  }
  if (options.sweeps > 0 && !corrects(options)) {
    throw InputError("sweeps: " + std::to_string(options.sweeps) + " with method " +
                     std::string(name_of(options.method)) + " and source " + std::string(name_of(options.source)) +
                     "; transport corrects method fem with source buried alone, else allowed is 0");
  }
  if (!sweep_points_range.contains(options.sweep_points)) {
    throw InputError("sweep_points: " + std::to_string(options.sweep_points) + ", allowed are " +
                     sweep_points_range.text());
  }
  if (!certify_range.contains(options.certify)) {
    throw InputError("certify: " + std::to_string(options.certify) + " s, allowed are " + certify_range.text());
  }
  if (options.certify > 0 && !corrects(options)) {
    throw InputError(
        "certify: what is certified is a corrected solve, of method fem with source buried; else allowed is 0");
  }
  check_options(options.path);
}

bool corrects(const SolveOptions& options) {
  return options.correction && options.method == Method::fem && options.source == Source::buried;
}

bool gathers(Method method, Source source) {
  return on_vertices(method) && source == Source::buried;
}

bool bounces_wanted(const SolveOptions& options) {
  return options.inter_reflection && options.source == Source::buried && conserves(options.method);
}

}  // namespace quadgraph
