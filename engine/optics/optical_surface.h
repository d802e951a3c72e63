// Where a body meets the air: bare or under a coat, smooth or rough.
#pragma once

#include "engine/optics/coat.h"
#include "shaders/shared/optical_surface.h"

namespace quadgraph {

// What a surface is like beside the body's index of refraction.
struct Finish {
  Coat coat{};
  float roughness = 0;  // GGX alpha of the body's own surface, for light that goes in and out by it

  bool operator==(const Finish&) const = default;
};

struct OpticalSurface : Finish {
  double eta = 1;  // index of refraction of the body, over that outside

  OpticalSurface() = default;
  // A bare and smooth one.
  OpticalSurface(double index) : eta(index) {}  // NOLINT: a number says all of it
  OpticalSurface(double index, const Coat& over, float alpha = 0) : Finish{over, alpha}, eta(index) {}

  bool operator==(const OpticalSurface&) const = default;

  bool rough() const { return roughness > 0 && (eta != 1 || coat.share > 0); }
  OpticalSurface smooth() const { return {eta, coat}; }
};

// Of a smooth surface all that passes know.
inline gpu::OpticalSurface single_precision(const OpticalSurface& surface) {
  return {static_cast<float>(surface.eta), surface.coat.eta, surface.coat.share, surface.coat.roughness, 0, {}};
}

}  // namespace quadgraph
