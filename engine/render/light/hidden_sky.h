// What of an environment other parts of the body hide: by the rays that say what its faces see of each other
// (docs/qgraph-format.md), on the level that has them and all finer ones.
#pragma once

#include <vector>

#include "engine/device/pipeline.h"
#include "engine/file/graph.h"
#include "engine/render/light/shadow_maps.h"
#include "engine/solve/simulation.h"

namespace quadgraph {

class HiddenSky {
 public:
  // `graph` must stay alive.
  HiddenSky(device::Device& device, const QuadGraph& graph);

  // For all environments of `lights`, as many as `environments`, from where the simulation's rays are now.
  PassStats run(Simulation& simulation, const ShadowMaps& lights, std::uint32_t environments);

  // Address of the last run's result for a level, vec3 per environment and face: what is hidden of q, over the light's
  // power; 0 where nothing is known.
  std::uint64_t hidden(std::uint32_t level) const { return level < hidden_.size() ? hidden_[level].address() : 0; }

 private:
  struct Finer {
    device::Buffer index, weight;
    std::uint32_t width = 0;
  };

  void make_room(Simulation& simulation, std::uint32_t level, std::uint32_t environments);

  device::Device& device_;
  const QuadGraph& graph_;
  device::ComputePass hide_, refine_;
  std::vector<device::Buffer> hidden_;  // per level, finest first, the last that with the rays
  std::vector<Finer> finer_;            // transfers, finest first
};

}  // namespace quadgraph
