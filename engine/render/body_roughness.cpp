#include "engine/render/body_roughness.h"

#include <algorithm>

#include "engine/optics/edit.h"

namespace quadgraph {

BodyRoughness::BodyRoughness(device::Device& device, const QuadGraph& graph, std::span<const BodyMaterial> materials)
    : count_(static_cast<std::uint32_t>(materials.size())) {
  const auto [least, most] = std::ranges::minmax(materials, {}, &BodyMaterial::roughness);
  least_ = least.roughness;
  most_ = most.roughness;
  if (least_ == most_) return;
  const float wide = static_cast<float>(count_);
  box_ = image_box({.size = glm::vec3(wide, 1, 1)});
  std::vector<glm::vec3> texels, places;
  for (const BodyMaterial& material : materials) texels.emplace_back((material.roughness - least_) / (most_ - least_));
  for (std::uint32_t face : graph.display().face) {
    const auto body = static_cast<float>(graph.levels()[0].body_of_face(face));
    places.emplace_back(body + 0.5f - 0.5f * wide, 0, 0);
  }
  texels_ = device::upload<glm::vec3>(device, texels, "picture/roughness by body");
  places_ = device::upload<glm::vec3>(device, places, "picture/places of bodies");
}

std::optional<PlacedRoughness> BodyRoughness::placed() const {
  if (least_ == most_) return std::nullopt;
  return PlacedRoughness{texels_, places_, box_, {0, count_, 1, 1}, most_};
}

}  // namespace quadgraph
