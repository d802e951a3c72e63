// The light that enters the body: q at the outside faces of a level.
#pragma once

#include <optional>

#include "engine/device/commands.h"
#include "engine/device/pipeline.h"
#include "engine/render/light/shadow_maps.h"
#include "engine/solve/level_buffers.h"

namespace quadgraph {

// Writes level.beam_q, as far as the lights go, and from it level.q: the mean over the face of the sum over lights
// of visibility * max(0, n.l) * E * F_t(n.l, eta), n the face's normal, E the irradiance facing the light, F_t the
// exact Fresnel transmittance; for ambient light of the share of the sky that the face sees (LevelBuffers::sky); for an
// environment all of it without what is hidden. The mean, and not the value at the surface node, because the solvers
// take q as constant over a face; so no light is lost or won at shadow edges, and a face of a coarse level sees the
// same light as its fine ones.
class IrradiancePass {
 public:
  explicit IrradiancePass(device::Device& device);

  // `level` counts from the finest, 0; faces of coarser levels are sampled more finely. `hidden` as
  // HiddenSky::hidden. `rough`: in motion, coarser levels as the finest, and of many faces, which are small,
  // each quarter by one sample instead of four.
  // Returns the bytes it moves.
  std::uint64_t record(device::Commands& commands, const LevelBuffers& buffers, std::uint32_t level,
                       const ShadowMaps& shadows, std::uint64_t hidden = 0, bool rough = false);

 private:
  const device::ComputePass& pass(bool shaped);

  device::Device& device_;
  device::ComputePass pass_;
  std::optional<device::ComputePass> shaped_;  // where some light has a shape, made at first use
};

}  // namespace quadgraph
