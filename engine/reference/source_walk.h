// The buried source on the CPU, in double precision: refracted rays followed from the lit faces through the tets by
// their links, leaving sigma_s' e^(-tau) where they pass. The GPU does the same in shaders/source/walk_source.comp.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/file/graph.h"
#include "engine/reference/operator.h"
#include "shaders/solver/solve_shared.h"

namespace quadgraph {

// Transmitted irradiance on the quarters of a face, W/mm^2: at its three corners, then in the middle.
using Quarters = std::array<glm::vec3, 4>;

// Light as the quarters of faces have it, W/mm^2 by channel.
class QuarterLight {
 public:
  static constexpr std::uint32_t whole = 4;

  explicit QuarterLight(std::span<const Quarters> quarters) : quarters_(quarters) {}

  // Of a quarter, or the mean of all: `whole`.
  std::array<double, 3> at(std::uint32_t f, std::uint32_t quarter) const {
    const Quarters& q = quarters_[f];
    const glm::dvec3 mean = (glm::dvec3(q[0]) + glm::dvec3(q[1]) + glm::dvec3(q[2]) + glm::dvec3(q[3])) / 4.0;
    const glm::dvec3 value = quarter == whole ? mean : glm::dvec3(q[quarter]);
    return {value.x, value.y, value.z};
  }

 private:
  std::span<const Quarters> quarters_;
};

struct WalkResult {
  // W per carrier of the method: the power that scatters for the first time, integrated against the carrier's basis
  // function (fem: linear, exactly along every ray; graph methods: the tet).
  std::vector<glm::dvec3> scattered;
  std::vector<glm::dvec3> unscattered;  // W per outside face: what leaves without having scattered
  glm::dvec3 entered{0};                // W
  glm::dvec3 absorbed{0};               // W, before scattering
  glm::dvec3 unscattered_out{0};        // W; more than the sum over faces where light was trapped in a clear region
};

// Rays of one beam: from the centroid of a face whose quarters agree (within 1/16 of the largest) and that is compact
// (longest edge^2 <= 8 area), else from the centroids of its quarters. Inside a tet the coefficients are those of its
// inner node. At an open face the Fresnel share leaves and the rest is mirrored, at a reflecting face all of it. Where
// each channel has kept less than WALK_END of the ray's power, what is left scatters and is absorbed on the spot. For
// every ray and channel entered = scattered + absorbed + unscattered_out, to rounding, whatever the elements' size.
// `problem` must be valid (assemble checks it); `quarters` has one entry per outside face.
WalkResult walk_source(const Level& level, const Problem& problem, const gpu::BeamRecord& beam,
                       std::span<const Quarters> quarters);

}  // namespace quadgraph
