// What a transport correction made of the exitance, carried on as a factor at each face to frames that have none: the
// light turns, the material changes and the shape moves faster than what the model gets wrong of them
// (docs/physics.md, "Transport correction").
#pragma once

#include <optional>
#include <vector>

#include "engine/reference/solution.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/operators.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

class CarriedCorrection {
 public:
  CarriedCorrection(device::Device& device, const LevelBuffers& level);

  // To be recorded before a correction has changed the exitance, W/mm^2 per outside face, and behind.
  void record_solved(Workspace& work, const LevelBuffers& level, const device::Buffer& exitance);
  void record_corrected(Workspace& work, const device::Buffer& exitance);

  // That was of a solve by `key`.
  void keep(const OperatorKey& key) { key_ = key; }

  // What is known of the error of that, behind all that is stated of it.
  void keep_error(const SolveReport& report);
  void forget() {
    key_.reset();
    error_.reset();
  }
  bool knows(const OperatorKey& key) const { return key_ == key; }

  // Of a solve by the same key: exitance times the factor. `material`: share of the coefficients that are as they were.
  void record(Workspace& work, const LevelBuffers& level, const device::Buffer& exitance, double material);

  // Once that has run: the share of light and material that is as it was, and what that leaves of the error.
  void state(SolveReport& report, double material) const;

 private:
  std::optional<OperatorKey> key_;
  std::optional<ErrorEstimate> error_, mesh_error_, model_error_;  // behind the correction
  ErrorEstimate changed_;                                          // by it
  device::Buffer solved_, corrected_, light_;                      // vec3 per face, W/mm^2
  device::Buffer overlap_, overlap_on_host_;                       // vec3 of light_change.comp
};

}  // namespace quadgraph
