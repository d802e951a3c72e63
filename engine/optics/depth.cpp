#include "engine/optics/depth.h"

#include "engine/base/all_cores.h"
#include "engine/optics/nearest_face.h"

namespace quadgraph {

std::vector<float> depth_below_surface(const Level& level, std::span<const glm::vec3> points) {
  const NearestFace surface(level);
  std::vector<float> depth(points.size());
  on_all_cores(points.size(), [&](std::size_t i) { depth[i] = surface.find(points[i]).distance; });
  return depth;
}

}  // namespace quadgraph
