#include "engine/render/default_lights.h"

#include <glm/geometric.hpp>

namespace quadgraph {
namespace {

constexpr float key_irradiance = 1e-3f;   // W/mm^2, about the sun's
constexpr float side_irradiance = 3e-4f;  // W/mm^2

Light from(const Camera& camera, const glm::vec3& source, float irradiance) {
  const glm::vec3 towards = source.x * camera.right + source.y * camera.up + source.z * camera.backward;
  return {.kind = LightKind::directional, .direction = -glm::normalize(towards), .power = glm::vec3(irradiance)};
}

}  // namespace

std::vector<Light> default_lights(const View& view) {
  const Camera camera = place_camera(view, {{0, 0, 0}, 1}, 1);
  return {from(camera, {-0.5f, 0.45f, -1.0f}, key_irradiance), from(camera, {1.0f, 0.35f, 0.25f}, side_irradiance)};
}

}  // namespace quadgraph
