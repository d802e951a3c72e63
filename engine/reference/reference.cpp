#include "engine/reference/reference.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/error.h"
#include "engine/file/geometry.h"
#include "engine/optics/depth.h"
#include "engine/reference/even_exitance.h"
#include "engine/reference/exitance.h"
#include "engine/reference/row_solver.h"
#include "engine/reference/source_walk.h"
#include "engine/reference/stored_entries.h"
#include "shaders/material/material.h"

namespace quadgraph {
namespace {

using Vector = std::vector<Field>;

glm::dvec3 in_tet(const Level& level, Method method, std::span<const glm::dvec3> values, std::uint32_t t) {
  if (!on_vertices(method)) return values[t];
  const glm::uvec4& tet = level.tets[t];
  return (values[tet[0]] + values[tet[1]] + values[tet[2]] + values[tet[3]]) / 4.0;
}

// Of the lights, without what enters again: W/mm^2 per outside face.
std::vector<glm::dvec3> from_outside(std::span<const EnteringLight> lights, std::size_t face_count) {
  std::vector<glm::dvec3> q(face_count, glm::dvec3(0));
  for (const EnteringLight& light : lights) {
    if (light.beam.kind == gpu::BEAM_MEAN) continue;
    for (std::size_t f = 0; f < face_count; ++f) q[f] += glm::dvec3(light.q[f]);
  }
  return q;
}

void add_surface(const Level& level, const Problem& problem, std::span<const EnteringLight> lights,
                 ReferenceSolution& solution) {
  const Boundaries boundaries = problem.boundaries();
  const std::vector<std::uint32_t> body = carrier_bodies(level, problem.method);
  std::vector<glm::dvec3> flux;
  for (std::size_t i = 0; i < solution.phi.size(); ++i) {
    const Boundary& boundary = boundaries.of(body[i]);
    flux.push_back(boundary.k11 * solution.phi[i] + boundary.k12 * solution.phi2[i]);
  }
  solution.phi_face = over_faces<glm::dvec3>(level, problem.method, solution.phi);
  if (problem.source == Source::buried) {
    solution.flux = clipped_exitance(level, problem.method, std::move(flux), solution.clipped);
  } else {
    solution.flux = over_faces<glm::dvec3>(level, problem.method, flux);
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      if (level.reflecting(f)) continue;
      const double reflected = boundaries.behind(level, f).reflected;
      for (const EnteringLight& light : lights) solution.flux[f] -= reflected * glm::dvec3(light.q[f]);
    }
  }
  solution.energy.scattered_out = surface_integral<glm::dvec3>(level, solution.flux);
  solution.exitance = solution.flux;
  if (problem.method == Method::fem && problem.source == Source::buried) {
    make_even(level, problem, from_outside(lights, level.face_count()), solution.exitance);
  }
}

void add_absorbed(const Level& level, const Problem& problem, ReferenceSolution& solution) {
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    solution.energy.absorbed += tet_volume(level, level.tets[t]) * glm::dvec3(problem.optical[t].sigma_a) *
                                in_tet(level, problem.method, solution.phi, t);
  }
}

void add(std::vector<Field>& sum, const std::vector<Field>& part) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = sum[i] + part[i];
}

// What one light adds to b of the diffuse source.
Vector surface_load(const Level& level, const Problem& problem, const EnteringLight& light,
                    ReferenceSolution& solution) {
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    solution.energy.entered += face_area(level, level.faces[f]) * glm::dvec3(light.q[f]);
  }
  return diffuse_load(level, problem, light.q);
}

// What one light adds to b of the buried source, and what it does before it scatters.
Vector walked_load(const Level& level, const Problem& problem, const EnteringLight& light,
                   ReferenceSolution& solution) {
  std::vector<Quarters> quarters;
  for (const glm::vec3& q : light.q) quarters.push_back({q, q, q, q});
  const WalkResult walk = walk_source(level, problem, light.beam, quarters);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    solution.unscattered[f] += walk.unscattered[f] / face_area(level, level.faces[f]);
  }
  solution.energy.entered += walk.entered;
  solution.energy.absorbed += walk.absorbed;
  solution.energy.unscattered_out += walk.unscattered_out;
  return buried_load(level, problem, walk.scattered);
}

Vector load(const Level& level, const Problem& problem, std::span<const EnteringLight> lights,
            ReferenceSolution& solution) {
  solution.unscattered.assign(level.faces.size(), glm::dvec3(0));
  Vector b(carrier_count(level, problem.method));
  for (const EnteringLight& light : lights) {
    const bool buried = problem.source == Source::buried;
    add(b, buried ? walked_load(level, problem, light, solution) : surface_load(level, problem, light, solution));
  }
  return b;
}

}  // namespace

std::vector<gpu::Optical> evaluate_material(const Level& level, const gpu::Material& material) {
  return evaluate_material(level, material, level.nodes);
}

std::vector<gpu::Optical> evaluate_material(const Level& level, const gpu::Material& material,
                                            std::span<const glm::vec3> points) {
  std::vector<float> depth(points.size(), 0.0f);
  if (material.pattern == gpu::PATTERN_LAYERS) depth = depth_below_surface(level, points);
  std::vector<gpu::Optical> optical;
  optical.reserve(points.size());
  for (std::size_t i = 0; i < depth.size(); ++i) optical.push_back(gpu::material_at(material, points[i], depth[i]));
  return optical;
}

ReferenceSolution solve_reference(const Level& level, std::span<const gpu::Optical> optical, const Indices& eta,
                                  std::span<const EnteringLight> lights, const SolveOptions& options, Entries entries) {
  const Problem problem{options.method, options.source, options.model, optical, eta};
  Rows rows = assemble(level, problem);
  if (entries == Entries::stored && format_of(level, options.method) == EntryFormat::packed) {
    rows = as_packed(std::move(rows), options.model);
  }
  ReferenceSolution solution;
  const Vector b = load(level, problem, lights, solution);
  solution.report.unknowns = static_cast<std::uint32_t>(rows.size()) * (options.model == Model::sp3 ? 2 : 1);
  const Vector x = solve_rows(rows, b, options, solution.report);
  for (std::size_t i = 0; i < x.size(); ++i) {
    solution.phi.push_back(rows.to_phi[i] * x[i].phi);
    solution.phi2.push_back(rows.to_phi[i] * x[i].phi2);
  }
  add_surface(level, problem, lights, solution);
  add_absorbed(level, problem, solution);
  return solution;
}

}  // namespace quadgraph
