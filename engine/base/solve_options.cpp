#include "engine/base/solve_options.h"

#include <array>
#include <string>
#include <utility>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

constexpr std::array<std::pair<std::string_view, Method>, 6> methods = {
    {{"quadgraph-fdm", Method::quadgraph_fdm},
     {"quadgraph-fv", Method::quadgraph_fv},
     {"fem", Method::fem},
     {"polygrid", Method::polygrid},
     {"polygrid-divergence", Method::polygrid_divergence},
     {"shortest-path", Method::shortest_path}}};
constexpr std::array<std::pair<std::string_view, SolverKind>, 6> solvers = {{{"fmg-pcg", SolverKind::fmg_pcg},
                                                                             {"vcycle", SolverKind::vcycle},
                                                                             {"dpcg", SolverKind::dpcg},
                                                                             {"cascade", SolverKind::cascade},
                                                                             {"jacobi", SolverKind::jacobi},
                                                                             {"auto", SolverKind::automatic}}};
constexpr std::array<std::pair<std::string_view, Source>, 2> sources = {
    {{"buried", Source::buried}, {"diffuse", Source::diffuse}}};
constexpr std::array<std::pair<std::string_view, Model>, 3> models = {
    {{"diffusion", Model::diffusion}, {"sp3", Model::sp3}, {"auto", Model::automatic}}};

template <typename Table>
auto from_name(const Table& table, std::string_view what, std::string_view name) {
  std::string allowed;
  for (const auto& [known, value] : table) {
    if (known == name) return value;
    allowed += (allowed.empty() ? "" : ", ") + std::string(known);
  }
  throw InputError(std::string(what) + " '" + std::string(name) + "': allowed are " + allowed);
}

template <typename Table, typename Value>
std::string_view to_name(const Table& table, Value wanted) {
  for (const auto& [name, value] : table) {
    if (value == wanted) return name;
  }
  return "unknown";
}

}  // namespace

void check_options(const SolveOptions& options) {
  if (!(options.tolerance > 0) || !(options.tolerance < 1)) {
    throw InputError("tolerance: " + std::to_string(options.tolerance) + ", a number between 0 and 1 is wanted");
  }
  if (!(options.error >= 0) || !(options.error < 1)) {
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
  check_options(options.path);
}

Method method_from_name(std::string_view name) {
  return from_name(methods, "method", name);
}
SolverKind solver_from_name(std::string_view name) {
  return from_name(solvers, "solver", name);
}
Source source_from_name(std::string_view name) {
  return from_name(sources, "source", name);
}
Model model_from_name(std::string_view name) {
  return from_name(models, "model", name);
}
std::string_view name_of(Method method) {
  return to_name(methods, method);
}
std::string_view name_of(SolverKind solver) {
  return to_name(solvers, solver);
}
std::string_view name_of(Source source) {
  return to_name(sources, source);
}
std::string_view name_of(Model model) {
  return to_name(models, model);
}

bool on_grid(Method method) {
  return method == Method::polygrid || method == Method::polygrid_divergence;
}

bool on_vertices(Method method) {
  return method == Method::fem || on_grid(method);
}

bool gathers(Method method, Source source) {
  return on_vertices(method) && source == Source::buried;
}

bool symmetric(Method method) {
  return !on_grid(method);
}

bool conserves(Method method) {
  return method == Method::fem || method == Method::quadgraph_fv;
}

bool published(Method method) {
  return method == Method::quadgraph_fdm || method == Method::polygrid;
}

bool bounces_wanted(const SolveOptions& options) {
  return options.inter_reflection && options.source == Source::buried && conserves(options.method);
}

}  // namespace quadgraph
