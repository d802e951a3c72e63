// Gathered radiance at single points, as numbers.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/device/pipeline.h"
#include "engine/solve/gather_field.h"

namespace quadgraph {

// Radiance that leaves points of the surface, W/(mm^2 sr), and the share of the background that is seen through them.
struct Leaving {
  std::vector<glm::vec3> radiance, transmittance;
};

class RadianceProbe {
 public:
  explicit RadianceProbe(device::Device& device);

  // At the centroids of outside faces along unit directions. Throws InputError for a face that is not there or a
  // direction that is not unit and outward.
  Leaving run(const Level& level, const GatherField& field, std::span<const std::uint32_t> face,
              std::span<const glm::vec3> direction);

 private:
  device::Device& device_;
  device::ComputePass pass_;
};

}  // namespace quadgraph
