#include "engine/render/light/default_lights.h"

#include <glm/geometric.hpp>

#include "engine/render/light/studio.h"

namespace quadgraph {
namespace {

// W/mm^2; the key is about as strong as the sun. Warm against cool keeps transmitted and reflected light apart.
constexpr glm::vec3 key_irradiance{1.0e-3f, 0.88e-3f, 0.72e-3f};
constexpr glm::vec3 side_irradiance{0.20e-3f, 0.21e-3f, 0.225e-3f};
constexpr glm::vec3 sky_irradiance{0.020e-3f, 0.022e-3f, 0.026e-3f};

Light from(const Camera& camera, const glm::vec3& source, const glm::vec3& irradiance) {
  const glm::vec3 towards = source.x * camera.right + source.y * camera.up + source.z * camera.backward;
  return {.kind = LightKind::directional, .direction = -glm::normalize(towards), .power = irradiance};
}

}  // namespace

std::vector<Light> default_lights(const View& view) {
  const Camera camera = place_camera(view, {{0, 0, 0}, 1}, 1);
  return {from(camera, {-0.5f, 0.45f, -1.0f}, key_irradiance),
          from(camera, {0.85f, 0.4f, 0.45f}, side_irradiance),
          {.kind = LightKind::ambient, .power = sky_irradiance}};
}

Light studio_of(const View& view) {
  Light light = parse_light(studio_name);
  light.turn = by_angles(view, {{0, 0, 0}, 1}).azimuth;
  if (view.up == UpAxis::z) light.up = {0, 0, 1};
  return light;
}

}  // namespace quadgraph
