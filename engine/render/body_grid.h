// The materials of several bodies as coefficients on a grid, for methods that know nothing of levels.
#pragma once

#include <span>
#include <vector>

#include "engine/file/graph.h"
#include "engine/optics/optical_grid.h"
#include "engine/render/body_material.h"

namespace quadgraph {

// An OpticalGrid that keeps what it has been given.
struct GivenGrid {
  OpticalGrid grid;
  std::vector<gpu::Optical> optical;
};

// Coefficients at points over the box of a level, in the shape at rest: in a tet those of its body's material there,
// close to the bodies those of what is near, and farther off an absorption that nothing looks up. materials: by body.
// Throws InputError where their indices of refraction differ, naming `bodies`.
GivenGrid grid_of_bodies(const Level& level, std::span<const BodyMaterial> materials,
                         std::span<const std::string> bodies);

}  // namespace quadgraph
