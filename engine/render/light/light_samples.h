// How far the irradiance of the finest level is from what rays find, by samples.
#pragma once

#include <optional>

#include "engine/base/pass_stats.h"
#include "engine/device/pipeline.h"
#include "engine/render/light/shadow_maps.h"
#include "engine/solve/simulation.h"

namespace quadgraph {

class LightSamples {
 public:
  explicit LightSamples(device::Device& device) : device_(device) {}

  // Writes room.difference from q and beam_q of `level`, which these lights have made.
  PassStats run(const LevelBuffers& level, const ShadowMaps& lights, const LightRoom& room);

 private:
  const device::ComputePass& pass(bool shaped);

  device::Device& device_;
  std::optional<device::ComputePass> plain_, shaped_;  // made at first use
};

}  // namespace quadgraph
