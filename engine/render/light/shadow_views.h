// From where shadow maps are drawn.
#pragma once

#include <vector>

#include "engine/render/display/camera.h"
#include "engine/render/light/lights.h"
#include "shaders/light/render_shared.h"

namespace quadgraph {

// The views of one light that together see all of `bounds` that it may shine on (depth address left 0): one
// orthographic view of a directional light, none of ambient light, environments and
// rectangles, which have those of their patches, one perspective view of another light outside 1.1
// times the sphere and of a spot light whose cone is narrower, else six of 90 degrees. Maps have sides of SHADOW_SIZE
// and so on, halved `halvings` times.
std::vector<gpu::ShadowView> shadow_views(const Light& light, const Sphere& bounds, std::uint32_t halvings);

// Views for light from a point of a surface that shines to the side `axis` points to; none if the body is behind it.
std::vector<gpu::ShadowView> patch_views(const glm::vec3& position, const glm::vec3& axis, const Sphere& bounds,
                                         std::uint32_t halvings);

}  // namespace quadgraph
