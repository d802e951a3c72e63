// What leaves the surface, as a grid that shaders and the host interpolate in.
#pragma once

#include <span>
#include <vector>

#include "engine/path/path_relaxation.h"

namespace quadgraph {

class ExitField {
 public:
  explicit ExitField(device::Device& device);

  void run(const Voxels& voxels, const PathRelaxation& paths, const gpu::PathTools& tools,
           std::vector<PassStats>& passes);

  const device::Buffer& field() const { return record_; }  // gpu::PathField, one

  // W/mm^2 at points, mm, as path_field.glsl has it.
  std::vector<glm::vec3> at(std::span<const glm::vec3> points) const;

 private:
  device::Device& device_;
  device::ComputePass pass_;
  gpu::PathGrid grid_{};
  device::Buffer cells_, record_;
};

}  // namespace quadgraph
