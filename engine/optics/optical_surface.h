// Where a body meets the air: smooth, bare or under a coat.
#pragma once

#include "engine/optics/coat.h"
#include "shaders/shared/optical_surface.h"

namespace quadgraph {

struct OpticalSurface {
  double eta = 1;  // index of refraction of the body, over that outside
  Coat coat{};

  OpticalSurface() = default;
  // A bare one.
  OpticalSurface(double index) : eta(index) {}  // NOLINT: a number says all of it
  OpticalSurface(double index, const Coat& over) : eta(index), coat(over) {}

  bool operator==(const OpticalSurface&) const = default;
};

inline gpu::OpticalSurface single_precision(const OpticalSurface& surface) {
  return {static_cast<float>(surface.eta), surface.coat.eta, surface.coat.share, surface.coat.roughness};
}

}  // namespace quadgraph
