#include "engine/render/picture/surface_maps.h"

#include "engine/render/light/normal_map_file.h"

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

const std::optional<NormalMap>& SurfaceMaps::own_normals() {
  const DisplayMesh& mesh = graph_.display();
  if (own_ || mesh.texture_places.empty()) return own_;
  Image picture{mesh.texture_columns, mesh.texture_rows, {}};
  for (std::size_t i = 0; i + 2 < mesh.normal_texture.size(); i += 3) {
    const std::uint8_t* rgb = &mesh.normal_texture[i];
    picture.texels.push_back(glm::vec3(rgb[0], rgb[1], rgb[2]) / 255.0f);
  }
  own_.emplace(std::make_shared<const ImagePyramid>(pyramid_of(slopes_from(std::move(picture)), most_texture_side)));
  texture_places_ = device::upload(device_, mesh.texture_places, "display/texture places");
  return own_;
}

PlacedNormals SurfaceMaps::placed(const NormalMap& map) {
  if (is_own(map)) {
    return {texels(normals_, map.slopes, "picture/normal map"),
            texture_places_,
            {},
            levels_of(*map.slopes),
            map.strength,
            true};
  }
  const Placement placement = map.placement ? *map.placement : around(graph_.display().vertices, graph_.front());
  return {texels(normals_, map.slopes, "picture/normal map"),
          at_rest(),
          image_box(placement),
          levels_of(*map.slopes),
          map.strength,
          false};
}

}  // namespace quadgraph
