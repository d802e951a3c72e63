// The surface with derivatives: from fluence at the vertices to what leaves the faces, and what of that meets the body
// again.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <mutex>
#include <span>
#include <vector>

#include "engine/derivative/traced.h"
#include "engine/file/graph.h"

namespace quadgraph {

// Values, derivatives, or weights, W/mm^2.
struct SurfaceLight {
  std::vector<glm::dvec3> exitance;  // M per outside face, as clipped_exitance makes it
  std::vector<glm::dvec3> received;  // E per outside face, of J = M + (1 - T_d) E; empty where nothing is seen
};

// Linearised at one state: `flux`, k11 phi + k12 phi2 per vertex, and E of the bounce before.
class Surface {
 public:
  // `reflected`: 1 - T_d. `received` is empty where the body sees nothing of itself.
  Surface(const Level& level, std::span<const glm::dvec3> flux, std::span<const glm::dvec3> received, double reflected);

  // The derivatives of what comes of these, per vertex and face.
  SurfaceLight tangent(std::span<const glm::dvec3> flux, std::span<const glm::dvec3> received) const;

  struct Inputs {
    std::vector<glm::dvec3> flux, received;
  };
  // The derivatives of weighted results by both. Several threads may ask: one is served after the other.
  Inputs adjoint(const SurfaceLight& weights) const;

 private:
  struct Channel {
    Tape tape;
    std::vector<Traced> exitance, received;
    std::vector<double> by_flux, by_received;
  };

  void record(int c, Channel& channel) const;

  const Level& level_;
  std::vector<glm::dvec3> flux_, received_;
  double reflected_;
  mutable std::mutex serving_;
  mutable std::array<Channel, 3> channels_;  // recorded when first wanted
};

// The values themselves.
SurfaceLight surface_light(const Level& level, std::span<const glm::dvec3> flux, std::span<const glm::dvec3> received,
                           double reflected);

}  // namespace quadgraph
