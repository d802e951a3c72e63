// What view rays gather on the finest level: fluence at its vertices, and the scale that makes the gathered radiance
// integrate to the exitance.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/file/graph.h"
#include "engine/solve/beams.h"
#include "engine/solve/body_tree.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/surface_results.h"
#include "engine/solve/transport_samples.h"
#include "engine/solve/workspace.h"
#include "shaders/gather/gather_shared.h"

namespace quadgraph {

// What was solved, on the finest level.
struct GatherInput {
  const LevelBuffers& level;
  FirstMoment fluence;  // at the vertices
  const BeamBuffers& beams;
  const device::Buffer& vertex_exitance;  // vec3 per surface vertex, W/mm^2
  gpu::BodyRef body;
  BodyTree& tree;                              // of the level
  std::optional<FirstScattered> first{};       // of a correction, whose exitance and fluence these are
  const ForwardScattering* forward = nullptr;  // the same, where light scatters forwards
};

class GatherField {
 public:
  // `tree`: of the level.
  GatherField(device::Device& device, const Level& level, const BodyTree& tree);

  // Room for a field of a correction. `level`: as above.
  void make_room_corrected(device::Device& device, const Level& level);

  // The same where light scatters forwards.
  void make_room_forward(device::Device& device, const Level& level);

  // The same where bodies within others bend light.
  void make_room_shared(device::Device& device, const Level& level);

  // The vertices of the level have moved.
  void moved() { normals_behind_ = true; }

  // Fluence of both kinds at the vertices, exitance of what is gathered, and their scale.
  void record(Workspace& work, const GatherInput& input);

  // Unscattered fluence alone, as it is, beside the exitance: what view rays then gather is scattered once (Jensen et
  // al. 2001, Eq. 6, along one refracted ray and with an isotropic phase function).
  void record_single(Workspace& work, const GatherInput& input);

  const gpu::SolidRef& solid() const { return solid_; }  // as it was last recorded
  const device::Buffer& solid_on_device() const { return solid_on_device_; }
  const device::Buffer& normals() const { return normals_; }    // vec3, three per face: of the smooth surface
  const device::Buffer& points() const { return points_; }      // GatherPoint per vertex
  const device::Buffer& gathered() const { return gathered_; }  // vec3 per face, W/mm^2: exitance of what is gathered
  const device::Buffer& scale() const { return scale_; }        // GatherScale per surface vertex
  const device::Buffer& nearest() const { return nearest_; }    // surface vertex of each vertex

 private:
  void write_solid(device::Device& device, const gpu::SolidRef& solid);
  void record_body(Workspace& work, const GatherInput& input);
  void record_normals(Workspace& work, const GatherInput& input);
  void record_shared_normals(Workspace& work, const GatherInput& input);
  void record_points(Workspace& work, const GatherInput& input);
  void record_uncollided(Workspace& work, const GatherInput& input);
  void record_first(Workspace& work, const GatherInput& input);
  void record_flow(Workspace& work, const GatherInput& input);
  void record_scale(Workspace& work, const GatherInput& input);
  void record_nodes(Workspace& work, const GatherInput& input);

  device::Buffer start_, nearest_;  // engine/reference/vertex_starts.h
  device::Buffer solid_on_device_, normals_, points_, gathered_, nodes_, scale_;
  device::Buffer flows_;                                       // of ForwardLight
  device::Buffer shared_vertex_, shared_offset_, shared_rim_;  // SharedSurface; made where light is bent within
  device::Buffer shared_normals_;                              // vec3 per vertex
  std::uint32_t shared_count_ = 0;                             // of shared_vertex_
  device::Buffer lacking_;  // vec3, at the corners of the tets, four each, W; of a correction alone
  gpu::SolidRef solid_{};
  bool normals_behind_ = true;
};

}  // namespace quadgraph
