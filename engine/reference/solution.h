// What a solve answers; the GPU solver and the CPU reference share it.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/solve_options.h"
#include "engine/reference/error_estimate.h"

namespace quadgraph {

struct Level;

// Power per channel. What enters, of the scene's light or again after leaving, is scattered out, absorbed, or leaves
// unscattered, for a conservative method.
struct Energy {
  glm::dvec3 entered{0};          // W, integral of the scene's q over the surface; corrected: of the rays that bring it
  glm::dvec3 re_entered{0};       // W, of light that had left another part of the body
  glm::dvec3 scattered_out{0};    // W, integral of M over the surface
  glm::dvec3 absorbed{0};         // W, integral of sigma_a times all fluence over the volume
  glm::dvec3 unscattered_out{0};  // W, of the buried source's rays, where they meet the surface from inside

  // (entered + re_entered - scattered_out - absorbed - unscattered_out) / entered; 0 in a channel without light.
  glm::dvec3 balance() const;
};

struct LevelReport {
  std::uint32_t level = 0;  // 0 is the finest
  std::uint32_t unknowns = 0;
  std::uint32_t iterations = 0;
  double residual = 0;  // sqrt(r^T D^-1 r / b^T D^-1 b), worst channel
  bool converged = false;
};

// What one sweep of the transport correction did to the exitance.
struct CorrectedSweep {
  ErrorEstimate change;  // against what it was before, without the noise of the sampling
  ErrorEstimate noise;   // of the sampling, in what it is now
  double points = 0;     // at which the transport equation was evaluated
};

// Of means over patches of the surface, after the last sweep.
struct CorrectedPatches {
  ErrorEstimate change;  // as CorrectionReport::changed
  ErrorEstimate noise;   // as of the last sweep
};

// What the transport correction did (docs/physics.md, "Transport correction").
struct CorrectionReport {
  std::vector<CorrectedSweep> sweeps;
  ErrorEstimate changed;  // against the solve that they started from, by all of them, in motion by those before as well
  ErrorEstimate taken{.whole = 1, .unlit = 1, .dimmest = 1};  // of what the sweeps changed the share that counts: less
                                                              // than 1 where that is little against the noise
  std::optional<CorrectedPatches> patches;                    // where they were measured
  double slow = 0;                                            // as of Resolution, on the finest level
  double returns = 0;    // share of the scattered light that leaves which enters again, the largest of any channel
  bool goes_on = false;  // one sweep, that goes on from those of the frames before
  double segments = 0;   // tets that rays back from its points and faces crossed
};

// What random walks measured of a part of the surface, with standard errors.
struct CertifiedPart {
  double power = 0, power_noise = 0;  // of the exitance: more than that of the walks, relative
  double error = 0, error_noise = 0;  // as ErrorEstimate: relative RMS, without the noise of the walks
};

// What random walks through the tets, which share nothing with the solution but these and their coefficients, say of it
// (docs/physics.md, "Certificate").
struct Certificate {
  // The parts of ErrorEstimate, the dimmest third by patches; zero where there are none, or too few walks came there.
  CertifiedPart whole, unlit, dimmest;
  double walks = 0, segments = 0;  // of one channel each; tets that they crossed
  double given_up = 0;             // share of the light in walks that were not followed to their end
  double seconds = 0;
  bool guided = false;         // walks knew where light matters
  std::string disagreement{};  // where the error that is stated is less than what was measured; empty if nowhere
};

// What leaves each outside face, W/mm^2, and its standard error: of light that has scattered, or of a material that
// says its g of all.
struct WalkedExitance {
  std::vector<glm::vec3> mean, standard_error;
};

// What Method::shortest_path did.
struct PathReport {
  PathOptions options;
  glm::uvec3 size{0};        // cells of the grid along x, y, z
  double cell = 0;           // mm, side of a cell
  std::uint32_t solid = 0;   // cells that are nodes
  std::uint32_t lit = 0;     // of them, those that light enters
  std::uint32_t rounds = 0;  // of blocks, until none had anything to gain
};

struct SolveReport {
  Method method = Method::fem;
  SolverKind solver = SolverKind::fmg_pcg;  // the one that was used, never `automatic`
  std::string replaced;                     // why it is not the one that was asked for; empty if it is
  Source source = Source::buried;
  Model model = Model::diffusion;   // the one that was solved, never `automatic`
  std::uint32_t cycles = 0;         // that were asked for; 0: as many as the tolerance took
  std::vector<LevelReport> levels;  // coarsest first, in the order solved
  std::uint32_t finest = 0;         // the level that was solved last; what leaves level 0 is carried there
  double work = 0;                  // products of all levels, in products of level 0
  double walk_segments = 0;         // tets that rays of the buried source crossed, on all levels
  Energy energy;                    // on the finest level
  // Share of the exitance, per channel, that linear elements put below zero and that was taken from the rest instead;
  // 0 with Source::diffuse, whose exitance stays as it is.
  glm::dvec3 clipped{0};
  // What further iterations would change, and no less than the share of the light that is unaccounted for; empty if
  // that cannot be told yet. After a correction what that leaves of it.
  std::optional<ErrorEstimate> algebraic;
  // Of a frame without a correction that shows the one before as a factor: the share of light and material that is as
  // it was then; empty elsewhere.
  std::optional<double> carried;
  // What the model leaves after a correction, and the noise of that; empty without.
  std::optional<ErrorEstimate> model_error;
  // That of the mesh: the difference between the exitance of the two finest levels, times the
  // share of it that is the finer one's own, and no less than what elements as deep as those at the surface leave
  // (engine/reference/resolution.h). Empty with a single level. After a correction what that leaves of it; of one at
  // rest with what a material that changes within tets costs (engine/solve/medium_error.h).
  std::optional<ErrorEstimate> mesh_error;
  // What the exitance is off by because the irradiance is (engine/solve/light_error.h); of what is corrected at rest,
  // under lights. Else empty.
  std::optional<ErrorEstimate> light_error;
  // What the angles of scattering change beyond the two moments that the solution knows: what random walks
  // found the exitance off by beyond all of the above (engine/solve/certificate.h). Of a material that says its g, and
  // what is corrected at rest; else empty.
  std::optional<ErrorEstimate> phase_error;
  // All of these together, as far as they are known. Empty where nothing is known of the mesh.
  std::optional<ErrorEstimate> error;
  std::string advice;             // of an error above 5%: where it comes from and what to do; else empty
  bool inter_reflection = false;  // whether inter-reflection was computed
  std::string missed;             // what was wanted of the error and is not met; empty if all is
  // How the level that was solved last stopped short of the tolerance; empty if it did not, if a number of cycles was
  // asked for, or if the error that was asked for is met all the same. Coarser levels only start it. And what is wrong
  // with the answer all the same (engine/render/verdict.h).
  std::string stopped;
  std::string budget;  // what the bake of the file has to say of the error that was asked for; empty if nothing
  // What else is to be said against the answer, of elements and of the model (engine/reference/resolution.h); empty if
  // nothing.
  std::string mesh_warning, model_warning;
  std::string size_warning;                    // of a material on a body of that size (engine/optics/body_size.h)
  std::string phase_warning;                   // of a material that scatters forwards (engine/optics/material.h)
  std::string index_warning;                   // of bodies within others (engine/render/body_material.h)
  std::string light_warning;                   // of lights that stand in the body; empty if none does
  std::string deformed;                        // tets of level 0 that a deformation has spoilt; empty if none is
  std::vector<glm::dvec3> bounces;             // W per channel that each bounce brought in
  std::optional<CorrectionReport> correction;  // of SolveOptions::sweeps
  std::optional<Certificate> certificate;      // of SolveOptions::certify
  std::optional<PathReport> path;  // of Method::shortest_path; it has no levels, no energy balance and no estimates
  std::uint32_t exchange_age = 0;  // solves that what some face sees has been behind the shape; 0: nothing is
};

// What was asked for and is not met, in words: `missed` and `stopped`, as far as there are.
std::vector<std::string> unmet(const SolveReport& report);

// Whether a program that made this ends with 3: the solve did not converge or, where that is held against it
// (`strict`), the error that was asked for is missed.
bool fails(const SolveReport& report, bool strict);

// Surface samples of one level: one per outside face, at its surface node.
struct SurfaceField {
  std::vector<glm::vec3> position;     // mm
  std::vector<glm::vec3> normal;       // unit, outward
  std::vector<float> area;             // mm^2
  std::vector<glm::vec3> q;            // W/mm^2
  std::vector<glm::vec3> phi;          // W/mm^2
  std::vector<glm::vec3> exitance;     // W/mm^2, of light that was scattered
  std::vector<glm::vec3> unscattered;  // W/mm^2, of light that was not
};

// Position, normal and area of the samples of a level.
SurfaceField surface_of(const Level& level);

}  // namespace quadgraph
