// What of an environment other parts of the body hide: by the rays that say what its faces see of each other
// (docs/qgraph-format.md), on the level that has them and all finer ones.
#pragma once

#include <vector>

#include "engine/file/graph.h"
#include "engine/render/light/shadow_maps.h"
#include "engine/solve/simulation.h"
#include "engine/vk/pipeline.h"

namespace quadgraph {

class HiddenSky {
 public:
  // `graph` must stay alive.
  HiddenSky(vk::Context& context, const QuadGraph& graph);

  // For all environments of `lights`, as many as `environments`, from where the simulation's rays are now.
  PassStats run(Simulation& simulation, const ShadowMaps& lights, std::uint32_t environments, float eta);

  // Address of the last run's result for a level, vec3 per environment and face: what is hidden of q, over the light's
  // power; 0 where nothing is known.
  VkDeviceAddress hidden(std::uint32_t level) const {
    return level < hidden_.size() ? hidden_[level].address() : VkDeviceAddress{0};
  }

 private:
  struct Finer {
    vk::Buffer index, weight;
    std::uint32_t width = 0;
  };

  void make_room(Simulation& simulation, std::uint32_t level, std::uint32_t environments);

  vk::Context& context_;
  const QuadGraph& graph_;
  vk::ComputePass hide_, refine_;
  std::vector<vk::Buffer> hidden_;  // per level, finest first, the last that with the rays
  std::vector<Finer> finer_;        // transfers, finest first
};

}  // namespace quadgraph
