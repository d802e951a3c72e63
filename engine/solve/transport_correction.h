// From the solve to the transport equation: what a sweep of the transport equation over the solved fluence changes is
// solved for by diffusion, and the exitance is gathered (docs/physics.md, "Transport correction"). What the sweep
// changes says how wrong the solve was. On the finest level.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/solve/beams.h"
#include "engine/solve/operators.h"
#include "engine/solve/source_walk.h"
#include "engine/solve/surface_results.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

// What a correction works with.
struct CorrectionParts {
  Workspace& work;
  const LevelBuffers& level;  // the finest
  const BeamBuffers& beams;
  const SourceWalk& walk;         // that has walked the scene's light on it, buried
  Operators& operators;           // those of `correction_key` have been created and hold the present coefficients
  const Boundary& boundary;       // of that operator
  const Solved& solved;           // fem
  const device::Buffer& nearest;  // surface vertex of each vertex (engine/reference/vertex_starts.h)
  const SurfaceResults& results;  // of the solve
};

// The operator of the correction.
inline constexpr OperatorKey correction_key{Method::fem, Model::diffusion};

// What the exitance is off by after all sweeps: the noise, and what another sweep would change. Measured on bodies that
// nobody tuned for (docs/accuracy.md).
ErrorEstimate corrected_error(const CorrectionReport& correction);

class TransportCorrection {
 public:
  // `level`: the finest, whose tets stay what they are.
  TransportCorrection(device::Device& device, const Level& level);

  // Room for sweeps of so many points, unless it is there.
  void make_room(device::Device& device, std::uint32_t points);

  // So many sweeps, from the solution. Throws SolverError where a value is not finite.
  CorrectionReport run(const CorrectionParts& parts, const SolveOptions& options, const WalkTask& task);

  // Of the last run: fluence at the vertices (vec3, scaled) and exitance of the faces, W/mm^2.
  const device::Buffer& fluence() const { return fluence_; }
  const device::Buffer& exitance() const { return exitance_; }

 private:
  void record_start(const CorrectionParts& parts, const WalkTask& task);
  void record_points(const CorrectionParts& parts);
  void record_sweep(const CorrectionParts& parts);
  void record_exitance(const CorrectionParts& parts);
  void record_load(const CorrectionParts& parts, OperatorBuffers& op, std::uint32_t half);
  void solve(const CorrectionParts& parts, std::uint32_t half);
  void record_change(const CorrectionParts& parts);
  void record_step(const CorrectionParts& parts);
  void record_faces(const CorrectionParts& parts);
  void draw(const CorrectionParts& parts, std::uint32_t draws);
  CorrectedSweep sweep(const CorrectionParts& parts);

  std::uint32_t points_wanted_ = 0, room_ = 0;
  std::uint32_t seed_ = 0;                     // of what was recorded last
  std::uint32_t draws_ = 0;                    // of points, in the load
  device::Buffer tet_offset_, tet_incidence_;  // tets around each vertex
  device::Buffer field_;                       // TransportFieldRef
  device::Buffer deposit_, first_;             // four per tet: fixed point; vec3, W/mm^3, scaled
  device::Buffer weights_, total_;             // vec2 per tet; float
  device::Buffer drawn_, points_;              // uint; TransportPoint
  device::Buffer segments_, segments_on_host_;
  device::Buffer load_;                                // fixed point, per vertex two per half
  device::Buffer gathered_;                            // vec3 per half and face, scaled
  std::array<device::Buffer, 2> right_side_, change_;  // vec3 per vertex: b and x of the solve of each half
  device::Buffer fluence_, exitance_;
  device::Buffer statistics_, statistics_on_host_;  // two TransportChange
};

}  // namespace quadgraph
