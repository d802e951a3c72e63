// The light that the ground under a body gets from what leaves the body's surface.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/device/commands.h"
#include "engine/device/pipeline.h"
#include "engine/file/graph.h"
#include "engine/solve/level_buffers.h"

namespace quadgraph {

// What sends it: the outside faces of a level in its present shape.
struct GroundSource {
  const Level& at_rest;
  const LevelBuffers& level;
  const device::Buffer& exitance;  // vec3 per outside face, W/mm^2
};

// A square of the ground.
struct GroundPart {
  glm::vec3 middle{0};   // mm
  float half_width = 0;  // mm
  bool z_up = false;     // it lies across z, else across y
};

class GroundLight {
 public:
  GroundLight(device::Device& device, const Level& level);

  // vec4 per texel of GROUND_LIGHT_SIZE^2, rows along the second axis of the ground: irradiance, W/mm^2, and the share
  // of the sky that the body takes, at most 1. Faces hide none of each other (shaders/display/ground_light.comp).
  const device::Buffer& light() const { return light_; }

  // `source` is of the level that this was made of, and nothing of it is below the ground.
  void record(device::Commands& commands, const GroundSource& source, const GroundPart& part);

  std::uint64_t bytes() const;  // read and written by what was recorded

 private:
  device::ComputePass patches_pass_, light_pass_;
  std::uint32_t face_count_, patch_faces_, patch_count_;
  device::Buffer order_, patches_, light_;
};

}  // namespace quadgraph
