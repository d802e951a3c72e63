// What a solve is asked; the GPU solver and the CPU reference share it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "engine/base/names.h"
#include "engine/base/path_options.h"
#include "engine/base/range.h"

namespace quadgraph {

enum class Method {
  quadgraph_fdm,        // the published 1/d^2 differences on kappa*phi at the nodes of the QuadGraph [QG Eq. 5-6]
  quadgraph_fv,         // two-point flux between the nodes of the QuadGraph, harmonic means of kappa
  fem,                  // linear elements on the tet vertices, consistent mass
  polygrid,             // the published differences of kappa*phi along the links of a polygrid [PG Eq. 9, Appendix B]
  polygrid_divergence,  // the same of the flux kappa grad phi, harmonic means of kappa
  shortest_path,  // no linear system: the light of the shortest optical path, through voxels (docs/shortest-path.md)
};

// Rows that are made alike: what the right-hand side and the CPU twin (engine/reference/operator.h) go by.
enum class Discretisation { none, fdm, fv, fem, polygrid };

struct MethodTraits {
  Discretisation discretisation = Discretisation::none;
  bool on_vertices = false;  // its carriers are the tet vertices, else the nodes of the QuadGraph
  bool on_grid = false;      // it needs the links of a polygrid
  bool symmetric = true;     // its matrix is, so that conjugate gradients take it
  bool conserves = false;    // its fluxes add up to the power that enters
  bool published = false;    // with Source::diffuse and Model::diffusion it has the published boundary
};

constexpr MethodTraits traits_of(Method method) {
  switch (method) {
    case Method::quadgraph_fdm:
      return {.discretisation = Discretisation::fdm, .published = true};
    case Method::quadgraph_fv:
      return {.discretisation = Discretisation::fv, .conserves = true};
    case Method::fem:
      return {.discretisation = Discretisation::fem, .on_vertices = true, .conserves = true};
    case Method::polygrid:
      return {.discretisation = Discretisation::polygrid,
              .on_vertices = true,
              .on_grid = true,
              .symmetric = false,
              .published = true};
    case Method::polygrid_divergence:
      return {.discretisation = Discretisation::polygrid, .on_vertices = true, .on_grid = true, .symmetric = false};
    case Method::shortest_path:
      return {};
  }
  return {};
}

constexpr bool on_vertices(Method method) {
  return traits_of(method).on_vertices;
}
constexpr bool on_grid(Method method) {
  return traits_of(method).on_grid;
}
constexpr bool symmetric(Method method) {
  return traits_of(method).symmetric;
}
constexpr bool conserves(Method method) {
  return traits_of(method).conserves;
}
constexpr bool published(Method method) {
  return traits_of(method).published;
}

enum class SolverKind {
  fmg_pcg,    // full-multigrid start, then conjugate gradients preconditioned by a V-cycle; fem only
  vcycle,     // full-multigrid start, then V-cycles; fem only
  dpcg,       // conjugate gradients with diagonal preconditioning, started from the coarser level
  cascade,    // relaxation from the coarsest level to the finest [QG Eq. 8-10, Fig. 9]
  jacobi,     // relaxation on the finest level alone
  automatic,  // "auto": fmg_pcg or dpcg, whichever took less time on this body and material
};

// How light enters the body.
enum class Source {
  buried,   // scattered along refracted rays inside; the surface only reflects and lets out
  diffuse,  // at the surface, as published [QG Eq. 2, PG Eq. 2]
};

// Whether view rays can gather all of its light: fluence at the vertices of tets, and a source below the surface.
bool gathers(Method method, Source source);

enum class Model {
  diffusion,  // one unknown per carrier: fluence phi
  sp3,        // simplified spherical harmonics: phi and its second moment phi2 (engine/reference/operator.h)
  automatic,  // "auto": diffusion where its known error is small (engine/optics/model.h), else sp3
};

template <>
struct Names<Method> {
  static constexpr std::string_view what = "method";
  static constexpr auto values = std::to_array<Named<Method>>(
      {{Method::fem, "fem", "linear finite elements on the tets"},
       {Method::quadgraph_fv, "quadgraph-fv", "finite volumes between the nodes of the QuadGraph, conservative"},
       {Method::quadgraph_fdm, "quadgraph-fdm", "finite differences between the nodes of the QuadGraph, as published"},
       {Method::polygrid, "polygrid",
        "finite differences along the links of a polygrid, as published, of a file baked with --mesher polygrid"},
       {Method::polygrid_divergence, "polygrid-divergence", "differences of the flux along the same links"},
       {Method::shortest_path, "shortest-path", "light along the shortest optical paths through voxels"}});
};

template <>
struct Names<SolverKind> {
  static constexpr std::string_view what = "solver";
  static constexpr auto values = std::to_array<Named<SolverKind>>(
      {{SolverKind::fmg_pcg, "fmg-pcg", "full multigrid, then conjugate gradients with V-cycles"},
       {SolverKind::vcycle, "vcycle", "full multigrid, then V-cycles"},
       {SolverKind::dpcg, "dpcg", "conjugate gradients with the diagonal"},
       {SolverKind::cascade, "cascade", "relaxation from the coarsest level to the finest, as published"},
       {SolverKind::jacobi, "jacobi", "relaxation on the finest level alone"},
       {SolverKind::automatic, "auto", "fmg-pcg or dpcg, whichever is quicker on this body and material"}});
};

template <>
struct Names<Source> {
  static constexpr std::string_view what = "source";
  static constexpr auto values =
      std::to_array<Named<Source>>({{Source::buried, "buried", "light scatters along refracted rays inside"},
                                    {Source::diffuse, "diffuse", "light enters at the surface, as published"}});
};

template <>
struct Names<Model> {
  static constexpr std::string_view what = "model";
  static constexpr auto values = std::to_array<Named<Model>>(
      {{Model::diffusion, "diffusion", "the diffusion equation"},
       {Model::sp3, "sp3", "simplified spherical harmonics of third order"},
       {Model::automatic, "auto", "diffusion where it is within 1% of sp3, and for the published baseline"}});
};

inline constexpr Range tolerance_range{.low = 0, .high = 1, .above = true, .below = true};
inline constexpr Range error_range{.low = 0, .high = 1, .below = true};
inline constexpr Range sweeps_range{.low = 0, .high = 100};
inline constexpr Range certify_range{.low = 0, .high = 86400};
inline constexpr Range sweep_points_range{.low = 1, .high = 10000000};
inline constexpr Range converge_range{.low = 0, .high = 1, .below = true};
inline constexpr Range time_limit_range{.low = 0, .high = 1000000};

struct SolveOptions {
  Method method = Method::fem;
  SolverKind solver = SolverKind::fmg_pcg;
  Source source = Source::buried;
  Model model = Model::automatic;
  // Stop when the estimated algebraic error of the exitance, as in ErrorEstimate, is no larger. The CPU reference stops
  // when sqrt(r^T D^-1 r / b^T D^-1 b) is no larger in any channel.
  double tolerance = 1e-3;
  std::uint32_t max_iterations = 5000;  // per level
  // n > 0: exactly n iterations (cycles, steps of conjugate gradients, sweeps) on the finest level, whatever is left.
  std::uint32_t cycles = 0;
  // Smoothing steps of a cycle before and after its correction, 1 or 2; 0: what is cheapest, 1 with conjugate gradients
  // and 2 without.
  std::uint32_t smoothing = 0;
  // From the last solution of the same method and model, where there is one, instead of from nothing.
  bool warm = false;
  // > 0: stop as soon as ErrorEstimate is no larger in both parts, on a level as coarse as that allows.
  double error = 0;
  // Light that leaves one part of the body and enters another, bounce by bounce (engine/reference/exchange.h). Only
  // with Source::buried, a file that has `seen`, and a method that conserves energy: of what quadgraph-fdm makes of
  // light, bounces can grow without end.
  bool inter_reflection = true;
  std::uint32_t bounces = 0;  // 0: from none until converged, at most 64; n: n more from the last state, for motion
  // Where the shape has changed: what the faces see of each other is found anew, for as many of them in each solve, in
  // turn; 0: for all.
  std::uint32_t exchange_rows = 0;
  // Uniform light (ambient, of environments) goes in along one ray from an origin, straight down with the optical depth
  // of the mean inside cosine, instead of eight: an eighth of that work. And every ray of the buried source ends, and
  // leaves the rest there, with a hundredth of its power instead of a ten-thousandth, and shadows are sampled at fewer
  // places. What that does to the exitance: docs/window.md.
  bool mean_rays = false;
  // Sweeps of the transport equation correct the solution, with Method::fem and Source::buried: so many, or with 0
  // until another one would change little. Scenes have it by default.
  bool correction = false;
  std::uint32_t sweeps = 0;
  std::uint32_t sweep_points = 20000;  // where a sweep evaluates it
  std::uint32_t sweep_seed = 0;        // of all that sweeps draw, and of the light's own rays
  // With `warm` and without correction: what the last one made of the exitance is carried on as a factor, if it was of
  // such a solve.
  bool carry = false;
  // The error that a correction at rest states is that of the mean of so many solves, alike but for their seeds; 0: of
  // this one alone.
  std::uint32_t mean_of = 0;
  double certify = 0;         // s: so long random walks measure what the corrected exitance is off by; 0: none do
  bool guided_walks = false;  // these are led to where little light leaves
  // n > 0, with the links of a polygrid: on all levels but the coarsest only the first n layers of vertices below the
  // surface are solved for, the others keep what the coarser level has [PG Section 5.3, Fig. 8]; 0: all are.
  std::uint32_t active_layers = 0;
  PathOptions path{};  // of Method::shortest_path, which looks at nothing else

  bool operator==(const SolveOptions&) const = default;
};

// Throws InputError naming what is out of range.
void check_options(const SolveOptions& options);

// Whether the solution is to be corrected, and can be.
bool corrects(const SolveOptions& options);

// inter_reflection, where source and method allow it.
bool bounces_wanted(const SolveOptions& options);

}  // namespace quadgraph
