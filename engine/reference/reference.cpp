#include "engine/reference/reference.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/error.h"
#include "engine/file/geometry.h"
#include "engine/optics/depth.h"
#include "engine/reference/even_exitance.h"
#include "engine/reference/source_walk.h"
#include "engine/reference/stored_entries.h"
#include "shaders/material/material.h"

namespace quadgraph {
namespace {

using Vector = std::vector<Field>;

glm::dvec3 dot(const Vector& a, const Vector& b) {
  glm::dvec3 sum{0};
  for (std::size_t i = 0; i < a.size(); ++i) sum += quadgraph::dot(a[i], b[i]);
  return sum;
}

// r^T D^-1 r, D the diagonal blocks.
glm::dvec3 scaled_norm(const Rows& rows, const Vector& r) {
  glm::dvec3 sum{0};
  for (std::size_t i = 0; i < r.size(); ++i) sum += quadgraph::dot(r[i], solve(rows.diagonal[i], r[i]));
  return sum;
}

// Worst channel of sqrt(r^T D^-1 r / b^T D^-1 b); channels without light count as solved. Throws SolverError if it is
// no number any more, which every comparison with a tolerance would let pass.
double relative(const glm::dvec3& r, const glm::dvec3& b) {
  double worst = 0;
  for (int c = 0; c < 3; ++c) {
    if (b[c] == 0) continue;
    const double residual = std::sqrt(r[c] / b[c]);
    if (!std::isfinite(residual)) {
      throw SolverError("the residual in channel " + std::to_string(c) +
                        " is not finite: the iteration diverged, or a tet or a link is too small for the operator");
    }
    worst = std::max(worst, residual);
  }
  return worst;
}

glm::dvec3 safe_ratio(const glm::dvec3& a, const glm::dvec3& b) {
  glm::dvec3 result{0};
  for (int c = 0; c < 3; ++c) {
    if (b[c] > 0) result[c] = a[c] / b[c];
  }
  return result;
}

// The largest eigenvalue of D^-1 A of linear tets is at most 4: a sum of positive semidefinite matrices has no larger
// quotient than its worst term, and an element of four blocks has none above 4.
constexpr double fem_bound = 4.0;

// Relaxation x += damping D^-1 (b - A x) from x = 0. Damping 1 is the published scheme.
void relax(const Rows& rows, const Vector& b, double damping, const SolveOptions& options, Vector& x,
           LevelReport& report) {
  const glm::dvec3 reference = scaled_norm(rows, b);
  for (;;) {
    Vector r = quadgraph::apply(rows, x);
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[i] - r[i];
    report.residual = relative(scaled_norm(rows, r), reference);
    if (report.residual <= options.tolerance || report.iterations == options.max_iterations) return;
    for (std::size_t i = 0; i < r.size(); ++i) x[i] = x[i] + glm::dvec3(damping) * solve(rows.diagonal[i], r[i]);
    ++report.iterations;
  }
}

// Conjugate gradients preconditioned by the diagonal blocks, every channel with its own step lengths.
void conjugate_gradients(const Rows& rows, const Vector& b, const SolveOptions& options, Vector& x,
                         LevelReport& report) {
  const glm::dvec3 reference = scaled_norm(rows, b);
  Vector r = b;
  Vector z(r.size()), p(r.size());
  glm::dvec3 rz_before{0};
  for (;;) {
    for (std::size_t i = 0; i < r.size(); ++i) z[i] = solve(rows.diagonal[i], r[i]);
    const glm::dvec3 rz = dot(r, z);
    report.residual = relative(rz, reference);
    if (report.residual <= options.tolerance || report.iterations == options.max_iterations) return;
    const glm::dvec3 beta = safe_ratio(rz, rz_before);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = z[i] + beta * p[i];
    const Vector ap = quadgraph::apply(rows, p);
    const glm::dvec3 curvature = dot(p, ap);
    for (int c = 0; c < 3; ++c) {
      if (rz[c] > 0 && !(curvature[c] > 0)) {
        throw SolverError("conjugate gradients met a direction of non-positive energy in channel " + std::to_string(c) +
                          " at iteration " + std::to_string(report.iterations) +
                          ": the matrix is not positive definite");
      }
    }
    const glm::dvec3 alpha = safe_ratio(rz, curvature);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = x[i] + alpha * p[i];
      r[i] = r[i] - alpha * ap[i];
    }
    rz_before = rz;
    ++report.iterations;
  }
}

// The mean of `values` (per carrier) over outside face f.
glm::dvec3 at_face(const Level& level, Method method, std::span<const glm::dvec3> values, std::uint32_t f) {
  if (!on_vertices(method)) return values[level.tet_count() + f];
  const glm::uvec3& face = level.faces[f];
  return (values[face[0]] + values[face[1]] + values[face[2]]) / 3.0;
}

glm::dvec3 in_tet(const Level& level, Method method, std::span<const glm::dvec3> values, std::uint32_t t) {
  if (!on_vertices(method)) return values[t];
  const glm::uvec4& tet = level.tets[t];
  return (values[tet[0]] + values[tet[1]] + values[tet[2]] + values[tet[3]]) / 4.0;
}

glm::dvec3 surface_integral(const Level& level, std::span<const glm::dvec3> faces) {
  glm::dvec3 sum{0};
  for (std::uint32_t f = 0; f < level.face_count(); ++f) sum += face_area(level, level.faces[f]) * faces[f];
  return sum;
}

std::vector<glm::dvec3> over_faces(const Level& level, Method method, std::span<const glm::dvec3> values) {
  std::vector<glm::dvec3> faces(level.faces.size(), glm::dvec3(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (!level.reflecting(f)) faces[f] = at_face(level, method, values, f);
  }
  return faces;
}

// M >= 0 at the faces for the buried source: negative values at the carriers become 0, the others pay for them.
std::vector<glm::dvec3> clipped_exitance(const Level& level, Method method, std::vector<glm::dvec3> carriers,
                                         glm::dvec3& clipped_share) {
  const glm::dvec3 raw = surface_integral(level, over_faces(level, method, carriers));
  for (glm::dvec3& m : carriers) m = glm::max(m, glm::dvec3(0));
  std::vector<glm::dvec3> faces = over_faces(level, method, carriers);
  const glm::dvec3 clipped = surface_integral(level, faces);
  const glm::dvec3 factor = safe_ratio(glm::max(raw, glm::dvec3(0)), clipped);
  for (glm::dvec3& m : faces) m *= factor;
  clipped_share = safe_ratio(clipped - raw, clipped);
  return faces;
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
  const Boundary boundary = problem.boundary();
  std::vector<glm::dvec3> flux;
  for (std::size_t i = 0; i < solution.phi.size(); ++i) {
    flux.push_back(boundary.k11 * solution.phi[i] + boundary.k12 * solution.phi2[i]);
  }
  solution.phi_face = over_faces(level, problem.method, solution.phi);
  if (problem.source == Source::buried) {
    solution.flux = clipped_exitance(level, problem.method, std::move(flux), solution.clipped);
  } else {
    solution.flux = over_faces(level, problem.method, flux);
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      if (level.reflecting(f)) continue;
      for (const EnteringLight& light : lights) solution.flux[f] -= boundary.reflected * glm::dvec3(light.q[f]);
    }
  }
  solution.energy.scattered_out = surface_integral(level, solution.flux);
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

ReferenceSolution solve_reference(const Level& level, std::span<const gpu::Optical> optical, double eta,
                                  std::span<const EnteringLight> lights, const SolveOptions& options, Entries entries) {
  const Problem problem{options.method, options.source, options.model, optical, eta};
  Rows rows = assemble(level, problem);
  if (entries == Entries::stored && format_of(level, options.method) == EntryFormat::packed) {
    rows = as_packed(std::move(rows), options.model);
  }
  ReferenceSolution solution;
  const Vector b = load(level, problem, lights, solution);
  solution.report.unknowns = static_cast<std::uint32_t>(rows.size()) * (options.model == Model::sp3 ? 2 : 1);
  Vector x(rows.size());
  if (symmetric(options.method) && options.solver != SolverKind::cascade && options.solver != SolverKind::jacobi) {
    conjugate_gradients(rows, b, options, x, solution.report);
  } else {
    const double damping = options.method == Method::fem ? 2.0 / fem_bound : 1.0;
    relax(rows, b, damping, options, x, solution.report);
  }
  solution.report.converged = solution.report.residual <= options.tolerance;
  for (std::size_t i = 0; i < x.size(); ++i) {
    solution.phi.push_back(rows.to_phi[i] * x[i].phi);
    solution.phi2.push_back(rows.to_phi[i] * x[i].phi2);
  }
  add_surface(level, problem, lights, solution);
  add_absorbed(level, problem, solution);
  return solution;
}

}  // namespace quadgraph
