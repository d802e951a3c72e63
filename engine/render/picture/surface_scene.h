// What the shaders of a picture read of the body, its light and the camera.
#pragma once

#include "engine/render/picture/rasteriser.h"

namespace quadgraph {

gpu::SurfaceScene surface_scene(const RasterInput& input, const Camera& camera);
gpu::SurfaceScene surface_scene(const PathInput& input, const Camera& camera);

}  // namespace quadgraph
