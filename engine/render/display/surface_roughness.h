// A surface that is smoother in some places than in others.
#pragma once

#include <memory>

#include "engine/base/image.h"
#include "engine/optics/edit.h"

namespace quadgraph {

// A picture projected onto the body: the surface keeps the picture's roughness where it is black, has `roughness` where
// its luminance is 1, and something between where that is.
struct RoughnessMap {
  std::shared_ptr<const ImagePyramid> image{};
  Placement placement{};
  float roughness = 0.05f;  // GGX alpha, 0.02 to 1

  bool operator==(const RoughnessMap&) const = default;
};

}  // namespace quadgraph
