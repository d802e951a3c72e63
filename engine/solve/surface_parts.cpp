#include "engine/solve/surface_parts.h"

#include <algorithm>
#include <numeric>

#include "engine/file/face_tree.h"

namespace quadgraph {
namespace {

float sum(const glm::vec3& v) {
  return v.x + v.y + v.z;
}

// The third of the surface with the least exitance; none where all is dark.
std::vector<bool> dimmest(const SurfaceField& field, const Listener& listener) {
  std::vector<bool> in(field.area.size());
  std::vector<std::uint32_t> order(in.size());
  std::iota(order.begin(), order.end(), 0u);
  std::size_t compared = 0;
  const auto dimmer = [&](std::uint32_t a, std::uint32_t b) {
    heed(listener, compared++);
    return sum(field.exitance[a]) < sum(field.exitance[b]);
  };
  std::sort(order.begin(), order.end(), dimmer);
  if (order.empty() || !(sum(field.exitance[order.back()]) > 0)) return in;
  double left = std::accumulate(field.area.begin(), field.area.end(), 0.0) / 3;
  for (const std::uint32_t face : order) {
    left -= static_cast<double>(field.area[face]);
    in[face] = true;
    if (left <= 0) break;
  }
  return in;
}

}  // namespace

// The node of the tree over the faces that each lies in, of those that number as many as there are patches.
std::vector<std::uint32_t> surface_patches(const Level& level, const Listener& listener) {
  const FaceTree tree = face_tree(level, listener);
  const std::uint32_t leaves = tree.leaves(), together = std::max(1u, leaves / most_patches);
  std::vector<std::uint32_t> patch(level.face_count());
  for (std::uint32_t leaf = 0; leaf < leaves; ++leaf) {
    for (std::uint32_t k = tree.leaf_begin[leaf]; k < tree.leaf_begin[leaf + 1]; ++k) {
      patch[tree.order[k]] = leaf / together;
    }
  }
  return patch;
}

SurfaceParts surface_parts(const SurfaceField& field, float unlit, const Listener& listener) {
  SurfaceParts parts{std::vector<bool>(field.area.size()), dimmest(field, listener)};
  for (std::size_t f = 0; f < field.area.size(); ++f) parts.unlit[f] = sum(field.q[f]) < unlit;
  return parts;
}

}  // namespace quadgraph
