// The light of a scene as the faces of one level have it, read back from the device.
#pragma once

#include <vector>

#include "engine/reference/source_walk.h"
#include "engine/solve/beams.h"

namespace quadgraph {

// A beam and what the quarters of every outside face let in of it.
struct LevelBeam {
  gpu::BeamRecord way{};
  std::vector<Quarters> quarters;
};

// All beams but that of light that enters again.
std::vector<LevelBeam> level_light(device::Device& device, const BeamBuffers& beams, const LevelBuffers& level);

}  // namespace quadgraph
