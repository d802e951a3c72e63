#include "engine/render/picture/surface_maps.h"

namespace quadgraph {
namespace {

gpu::ImageLevels levels_of(const ImagePyramid& image) {
  return {0, image.columns, image.rows, image.levels};
}

}  // namespace

const device::Buffer& SurfaceMaps::at_rest() {
  if (rest_.size() == 0) rest_ = device::upload<glm::vec3>(device_, graph_.display().vertices, "display/at rest");
  return rest_;
}

const device::Buffer& SurfaceMaps::texels(Kept& kept, const std::shared_ptr<const ImagePyramid>& image,
                                          const char* name) {
  if (kept.image != image) kept = {image, device::upload<glm::vec3>(device_, image->texels, name)};
  return kept.texels;
}

PlacedRoughness SurfaceMaps::placed(const RoughnessMap& map) {
  return {texels(roughness_, map.image, "picture/roughness image"), at_rest(), image_box(map.placement),
          levels_of(*map.image), map.roughness};
}

PlacedNormals SurfaceMaps::placed(const NormalMap& map) {
  const Placement placement = map.placement ? *map.placement : around(graph_.display().vertices, graph_.front());
  return {texels(normals_, map.slopes, "picture/normal map"), at_rest(), image_box(placement), levels_of(*map.slopes),
          map.strength};
}

}  // namespace quadgraph
