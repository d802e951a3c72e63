// Surfaces of several bodies, each as rough as its material says.
#pragma once

#include <optional>

#include "engine/device/device.h"
#include "engine/file/graph.h"
#include "engine/render/body_material.h"
#include "engine/render/picture/rasteriser.h"

namespace quadgraph {

// A roughness that is placed by an image (engine/render/display/surface_roughness.h): a row of texels, one for each
// body, in which every display vertex has the place of its body's. Between the smoothest and the roughest of three or
// more bodies what is mirrored of an environment is a mean of both; all else is exact.
class BodyRoughness {
 public:
  // materials: one for each body of the file.
  BodyRoughness(device::Device& device, const QuadGraph& graph, std::span<const BodyMaterial> materials);

  float least() const { return least_; }
  float most() const { return most_; }

  // What the rasteriser takes beside `least`; none where all are as rough.
  std::optional<PlacedRoughness> placed() const;

 private:
  float least_ = 0, most_ = 0;
  std::uint32_t count_ = 0;
  gpu::ImageBox box_{};
  device::Buffer texels_, places_;
};

}  // namespace quadgraph
