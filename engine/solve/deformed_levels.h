// The levels of a body as a list of deformers moves them on the device, and what becomes of their tets.
#pragma once

#include <span>
#include <vector>

#include "engine/reference/resolution.h"
#include "engine/solve/deformed_mesh.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

// A level in its deformed shape.
struct ShapeState {
  std::uint32_t tets = 0;
  std::uint32_t inverted = 0;            // turned inside out
  std::uint32_t flat = 0;                // flatter than least_quality, inverted ones left out
  double worst = 1;                      // least quality of a tet: 1 regular, 0 flat, below 0 inside out
  double conduction = 0;                 // mean, as format_of takes it (engine/reference/stored_entries.h)
  double chord = 0;                      // mm, as mean_chord
  std::vector<SurfaceSample> samples{};  // as surface_samples
};

// "12 of 172000 tets are turned inside out, 3 nearly flat; ..."; empty if none is.
std::string deformed_text(const ShapeState& state);

// Tets below this quality count as if they had it, so that no entry of an operator is beyond what packed ones can hold.
inline constexpr float least_quality = 1e-3f;

class DeformedLevels {
 public:
  // `rest` must stay alive.
  explicit DeformedLevels(const std::vector<Level>& rest);

  const std::vector<Deformer>& list() const { return list_; }  // empty: at rest

  // Vertices and nodes of all levels, and their states. `list` has been checked.
  void record(Workspace& work, std::span<const Deformer> list, const RestBox& box, std::vector<LevelBuffers>& levels);

  // Nodes of a level, which has got its buffer of them since.
  void record_nodes(Workspace& work, std::uint32_t number, const LevelBuffers& level);

  // State of a level after what has been recorded and has run.
  ShapeState state(std::uint32_t number) const;

  // All vertices and nodes as in the file; waits.
  void put_back(device::Device& device, std::vector<LevelBuffers>& levels);

 private:
  struct Measured {
    device::Buffer sums, samples;                  // ShapeSums per workgroup, vec2 per sample
    device::Buffer sums_on_host, samples_on_host;  // the same, mapped
    device::Buffer place;                          // vec4 per node: barycentric coordinates in its tet
    std::uint32_t step = 1;
  };

  void make_room(device::Device& device);
  void record_state(Workspace& work, std::uint32_t number, const LevelBuffers& level);

  const std::vector<Level>& rest_;
  std::vector<DeformedMesh> meshes_;
  std::vector<Measured> measured_;
  std::vector<Deformer> list_;
};

}  // namespace quadgraph
