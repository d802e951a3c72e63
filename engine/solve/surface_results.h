// What leaves the surface of the finest level, and where the power goes.
#pragma once

#include <optional>

#include "engine/reference/solution.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/operator_buffers.h"
#include "engine/solve/refractions.h"
#include "engine/solve/source_walk.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

// What was solved, as the passes over the surface need it.
struct Solved {
  const LevelBuffers& level;
  const OperatorBuffers& op;
  Method method;
  const BodyBoundaries& boundaries;
  const SourceWalk* walk;         // of the buried source, whose exitance is clipped; null for the diffuse one
  std::uint64_t unscattered = 0;  // address, fixed point per face: what left so; 0: that of the walk
};

// Fluence at the carriers of a method: the first moment of what is solved for.
struct FirstMoment {
  std::uint64_t x = 0, to_phi = 0;  // addresses, as of OperatorBuffers
  Model model = Model::diffusion;   // what x is made of
};

FirstMoment first_moment_of(const OperatorBuffers& op);

// phi and M (vec3 per outside face, W/mm^2) and the Clip, whose factor is left to be applied to M.
void record_exitance(Workspace& work, const Solved& solved, const device::Buffer& phi, const device::Buffer& exitance,
                     const device::Buffer& clip);

// M alone, read back; not clipped.
std::vector<glm::vec3> exitance_of(device::Device& device, Workspace& work, const Solved& solved);

class SurfaceResults {
 public:
  SurfaceResults(device::Device& device, const LevelBuffers& level);

  const device::Buffer& phi() const { return phi_; }            // vec3 per outside face, W/mm^2
  const device::Buffer& exitance() const { return exitance_; }  // vec3 per outside face, W/mm^2, scattered

  // vec3 per surface vertex, W/mm^2, for display: of scattered light, and of light that was not.
  const device::Buffer& vertex_exitance() const { return vertex_exitance_; }
  const device::Buffer& vertex_unscattered() const { return vertex_unscattered_; }

  // Exitance and energy of the final solution.
  void record(Workspace& work, const Solved& solved);

  // Exitance and energy of a solution that the transport correction has changed: fluence at the vertices (vec3, scaled)
  // and exitance of the faces, W/mm^2, of whose change so much counts (CorrectionReport).
  void record_corrected(Workspace& work, const Solved& solved, const device::Buffer& fluence,
                        const device::Buffer& exitance, const ErrorEstimate& taken);

  // What is displayed, anew, where the exitance has been changed since.
  void record_shown(Workspace& work, const Solved& solved) { record_display(work, solved); }

  // Energy of what was recorded last and has run, without the walk's share; and what was clipped in it.
  Energy energy() const;
  glm::dvec3 clipped() const;

 private:
  void record_vertex_exitance(Workspace& work, const LevelBuffers& level, const device::Buffer& faces, bool geometric);
  void record_even(Workspace& work, const Solved& solved);
  void record_display_scale(Workspace& work, const LevelBuffers& level);
  void record_display(Workspace& work, const Solved& solved);
  void record_vertex_unscattered(Workspace& work, const Solved& solved);
  void record_energy(Workspace& work, const Solved& solved, const FirstMoment& fluence);

  device::Buffer phi_, exitance_, vertex_exitance_, vertex_unscattered_;
  device::Buffer face_area_;       // mm^2, of the present vertices once the energy has been taken
  device::Buffer even_;            // EvenFace per face
  device::Buffer display_factor_;  // vec3
  device::Buffer clip_;            // Clip
  device::Buffer clip_on_host_;    // the same, mapped
  device::Buffer sums_;            // EnergySums per workgroup
  device::Buffer totals_;          // EnergySums, WORKGROUP_SIZE of them
  device::Buffer totals_on_host_;  // the same, mapped
};

}  // namespace quadgraph
