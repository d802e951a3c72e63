// Beams of light: what enters each face, by where it comes from.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/solve/level_buffers.h"
#include "shaders/solver/solve_shared.h"

namespace quadgraph {

// The beams of the scene's light, and last one of kind BEAM_MEAN for light that leaves the body and enters it again. It
// is in no LevelBuffers::q, and zero while there is none.
struct BeamBuffers {
  std::vector<gpu::Beam> beams;
  device::Buffer on_device;  // the same
};

// A beam of given q along `direction`, of any length, or a Lambertian one. Throws InputError unless it is finite and
// not zero.
gpu::Beam beam_along(const std::optional<glm::vec3>& direction);

// Replaces the beams by those of the scene's light and the one for light that enters again. If they need other room
// than the present ones, every level gets it, without light.
void replace_beams(device::Device& device, std::span<const gpu::Beam> beams, BeamBuffers& buffers,
                   std::vector<LevelBuffers>& levels);

// Light of the only beam, W/mm^2 per face, uniform over each. Throws InputError unless there is one value >= 0 for each
// face of level `number`.
void write_irradiance(device::Device& device, std::span<const glm::vec3> q, std::uint32_t number, LevelBuffers& level);

}  // namespace quadgraph
