// What leaves the surface of the finest level, and where the power goes.
#pragma once

#include <optional>

#include "engine/solve/operator_buffers.h"
#include "engine/solve/simulation.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

class SurfaceResults {
 public:
  SurfaceResults(vk::Context& context, const LevelBuffers& level);

  const vk::Buffer& phi() const { return phi_; }                          // vec3 per outside face, W/mm^2
  const vk::Buffer& exitance() const { return exitance_; }                // vec3 per outside face, W/mm^2
  const vk::Buffer& vertex_exitance() const { return vertex_exitance_; }  // vec3 per surface vertex, W/mm^2

  // Exitance of the solution transferred from the coarser level, to be compared with the final one.
  void record_coarse(Workspace& work, const LevelBuffers& level, Method method, double eta, const OperatorBuffers& op);

  // Exitance and energy of the final solution.
  void record(Workspace& work, const LevelBuffers& level, Method method, double eta, const OperatorBuffers& op);

  // Of what was recorded last and has run.
  Energy energy() const;
  ErrorEstimate error() const;

 private:
  void record_exitance(Workspace& work, const LevelBuffers& level, Method method, double eta, const OperatorBuffers& op,
                       const vk::Buffer& exitance);
  void record_vertex_exitance(Workspace& work, const LevelBuffers& level, Method method, double eta,
                              const OperatorBuffers& op);
  void record_energy(Workspace& work, const LevelBuffers& level, Method method, const OperatorBuffers& op);

  vk::Buffer phi_, exitance_, coarse_exitance_, vertex_exitance_;
  vk::Buffer sums_;          // EnergySums per workgroup
  vk::Buffer sums_on_host_;  // the same, mapped
};

}  // namespace quadgraph
