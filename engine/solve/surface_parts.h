// Patches and parts of a surface that errors of its exitance are told of.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/listener.h"
#include "engine/file/graph.h"
#include "engine/reference/solution.h"

namespace quadgraph {

// Errors are those of means over patches, about so many on the whole surface.
inline constexpr std::uint32_t most_patches = 256;

// The patch of each outside face, below most_patches: faces that lie together.
std::vector<std::uint32_t> surface_patches(const Level& level, const Listener& listener = {});

// Which faces are of the parts of ErrorEstimate.
struct SurfaceParts {
  std::vector<bool> unlit, dimmest;
};

// Of the field, position and normal are not looked at. unlit: W/mm^2, as of gpu::Scale.
SurfaceParts surface_parts(const SurfaceField& field, float unlit, const Listener& listener = {});

}  // namespace quadgraph
