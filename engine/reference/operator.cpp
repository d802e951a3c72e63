#include "engine/reference/operator.h"

#include <cmath>
#include <string>

#include "engine/base/error.h"
#include "engine/file/geometry.h"
#include "engine/optics/fresnel.h"
#include "engine/reference/discretisation.h"
#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

bool in_range(const gpu::Optical& optical) {
  for (int c = 0; c < 3; ++c) {
    if (!(optical.sigma_s_prime[c] >= 0 && optical.sigma_s_prime[c] <= gpu::COEFFICIENT_MAX)) return false;
    if (!(optical.sigma_a[c] >= 0 && optical.sigma_a[c] <= gpu::COEFFICIENT_MAX)) return false;
  }
  return true;
}

void check_problem(const Level& level, const Problem& problem) {
  check_optical(problem.optical, level.nodes.size());
  for (const double eta : problem.eta.values) check_eta(eta);
  const auto last = std::ranges::max_element(level.tet_bodies);
  const std::size_t bodies = last == level.tet_bodies.end() ? 1 : std::size_t{*last} + 1;
  if (problem.eta.values.size() != 1 && problem.eta.values.size() != bodies) {
    throw InputError("eta: " + std::to_string(problem.eta.values.size()) + " found, one for all, or one for each of " +
                     std::to_string(bodies) + " bodies wanted");
  }
  if (problem.model == Model::automatic) throw InputError("model 'auto': resolve it before assembling");
  check_method(level, problem.method);
}

void check_irradiance(const Level& level, std::span<const glm::vec3> q) {
  if (q.size() != level.faces.size()) {
    throw InputError("q: " + std::to_string(q.size()) + " entries, the level has " +
                     std::to_string(level.faces.size()) + " surface nodes");
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      if (!(q[i][c] >= 0 && std::isfinite(q[i][c]))) {
        throw InputError("q[" + std::to_string(i) + "]: " + std::to_string(q[i][c]) + ", allowed is a number >= 0");
      }
    }
  }
}

std::vector<glm::dvec3> surface_load(const Level& level, const Problem& problem, std::span<const glm::vec3> q) {
  switch (traits_of(problem.method).discretisation) {
    case Discretisation::fdm:
      return surface_load_fdm(level, problem, q);
    case Discretisation::fv:
      return surface_load_fv(level, q);
    case Discretisation::fem:
    case Discretisation::polygrid:
      return surface_load_fem(level, q);
    case Discretisation::none:
      break;
  }
  throw InputError("method: no system of linear equations");
}

}  // namespace

void check_optical(std::span<const gpu::Optical> optical, std::size_t count) {
  if (optical.size() != count) {
    throw InputError("optical: " + std::to_string(optical.size()) + " entries, the level has " + std::to_string(count) +
                     " nodes");
  }
  for (std::size_t i = 0; i < optical.size(); ++i) {
    if (!in_range(optical[i])) {
      throw InputError("optical[" + std::to_string(i) + "]: sigma_s_prime and sigma_a must be 0 to 1e6 (1/mm)");
    }
  }
}

std::vector<Method> methods_of(const Level& level) {
  std::vector<Method> methods = all_values<Method>();
  std::erase_if(methods, [&](Method method) {
    return method == Method::shortest_path || (on_grid(method) && level.grid_links.empty());
  });
  return methods;
}

void check_method(const Level& level, Method method) {
  if (on_grid(method) && level.grid_links.empty()) {
    throw InputError("method " + std::string(name_of(method)) +
                     ": the file has no polygrid; bake it with --mesher polygrid");
  }
}

void check_eta(double eta) {
  if (!(eta >= min_eta && eta <= max_eta)) throw InputError("eta " + std::to_string(eta) + ": allowed is 1 to 3");
}

glm::dvec3 relaxation_of(const gpu::Optical& optical) {
  return 5.0 / 9.0 * glm::dvec3(gpu::sigma_t(optical));
}

Boundaries Problem::boundaries() const {
  Boundaries found;
  for (const double index : eta.values) found.values.push_back(boundary_of(method, source, model, index));
  return found;
}

std::vector<std::uint32_t> carrier_bodies(const Level& level, Method method) {
  std::vector<std::uint32_t> body(carrier_count(level, method));
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    if (!on_vertices(method)) body[t] = level.body_of_tet(t);
    for (int k = 0; on_vertices(method) && k < 4; ++k) body[level.tets[t][k]] = level.body_of_tet(t);
  }
  for (std::uint32_t f = 0; f < level.face_count() && !on_vertices(method); ++f) {
    body[level.tet_count() + f] = level.body_of_face(f);
  }
  return body;
}

std::uint32_t carrier_count(const Level& level, Method method) {
  return on_vertices(method) ? level.vertex_count() : level.node_count();
}

Rows assemble(const Level& level, const Problem& problem) {
  check_problem(level, problem);
  switch (traits_of(problem.method).discretisation) {
    case Discretisation::fdm:
      return assemble_fdm(level, problem);
    case Discretisation::fv:
      return assemble_fv(level, problem);
    case Discretisation::fem:
      return assemble_fem(level, problem);
    case Discretisation::polygrid:
      return assemble_polygrid(level, problem);
    case Discretisation::none:
      break;
  }
  throw InputError("method: no system of linear equations");
}

std::vector<Field> diffuse_load(const Level& level, const Problem& problem, std::span<const glm::vec3> q) {
  check_problem(level, problem);
  check_irradiance(level, q);
  const Boundaries boundaries = problem.boundaries();
  const std::vector<std::uint32_t> body = carrier_bodies(level, problem.method);
  std::vector<Field> b;
  for (const glm::dvec3& load : surface_load(level, problem, q)) {
    const Boundary& boundary = boundaries.of(body[b.size()]);
    b.push_back({boundary.k11 * boundary.source * load, boundary.k12 * boundary.source * load});
  }
  return b;
}

std::vector<Field> buried_load(const Level& level, const Problem& problem, std::span<const glm::dvec3> scattered) {
  std::vector<Field> b(carrier_count(level, problem.method));
  for (std::size_t i = 0; i < scattered.size(); ++i) {
    // The published rows are per volume (operator.h), all others integrals.
    const bool density = problem.method == Method::quadgraph_fdm && i < level.tets.size();
    b[i].phi = density ? scattered[i] / tet_volume(level, level.tets[i]) : scattered[i];
  }
  return b;
}

std::vector<Field> apply(const Rows& rows, std::span<const Field> x) {
  std::vector<Field> y(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Field sum = rows.diagonal[i] * x[i];
    for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) sum = sum + rows.weight[k] * x[rows.column[k]];
    y[i] = sum;
  }
  return y;
}

}  // namespace quadgraph
