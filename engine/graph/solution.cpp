#include "engine/graph/solution.h"

#include <algorithm>
#include <string>

#include "engine/graph/error.h"
#include "engine/graph/geometry.h"

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
  check_options(options.path);
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

glm::dvec3 Energy::balance() const {
  glm::dvec3 result{0};
  for (int c = 0; c < 3; ++c) {
    if (!(entered[c] > 0)) continue;
    const double out = scattered_out[c] + absorbed[c] + unscattered_out[c];
    result[c] = (entered[c] + re_entered[c] - out) / entered[c];
  }
  return result;
}

SurfaceField surface_of(const Level& level) {
  SurfaceField field;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::dvec3 normal = face_vector(level, level.faces[f]);
    field.position.push_back(level.nodes[level.tet_count() + f]);
    field.normal.push_back(glm::vec3(normal / std::max(glm::length(normal), 1e-300)));
    field.area.push_back(static_cast<float>(0.5 * glm::length(normal)));
  }
  return field;
}

}  // namespace quadgraph
