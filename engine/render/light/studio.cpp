#include "engine/render/light/studio.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/render/light/image_file.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t columns = 256, rows = 128;
constexpr float edge = 4;  // degrees over which a box fades; the series of an environment has structures of 3

// Degrees: longitude from what is ahead to the right, latitude up.
struct SoftBox {
  float longitude, latitude, width, height;
  glm::vec3 radiance;
};

// From the front to the right, large; a strip to the left; and a warm one behind the object, which shows what comes
// through it.
constexpr std::array<SoftBox, 3> boxes = {{{140, 35, 60, 45, {5.0f, 4.9f, 4.75f}},
                                           {-115, 25, 28, 70, {2.0f, 2.1f, 2.2f}},
                                           {-28, 35, 30, 60, {14.0f, 13.0f, 11.5f}}}};
constexpr glm::vec3 floor_radiance{0.06f}, wall_radiance{0.08f}, ceiling_radiance{0.18f};

float inside(float distance, float width) {
  return std::clamp((width / 2 - std::abs(distance)) / edge + 0.5f, 0.0f, 1.0f);
}

glm::vec3 radiance_at(float longitude, float latitude) {
  const float up = std::sin(latitude * std::numbers::pi_v<float> / 180);
  glm::vec3 radiance = up > 0 ? wall_radiance + up * (ceiling_radiance - wall_radiance) : floor_radiance;
  for (const SoftBox& box : boxes) {
    const float beside = std::remainder(longitude - box.longitude, 360.0f);
    radiance += inside(beside, box.width) * inside(latitude - box.latitude, box.height) * box.radiance;
  }
  return radiance;
}

}  // namespace

Image studio_picture() {
  Image picture{columns, rows, {}};
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const float longitude = (static_cast<float>(column) + 0.5f) * 360 / columns - 180;
      picture.texels.push_back(radiance_at(longitude, 90 - (static_cast<float>(row) + 0.5f) * 180 / rows));
    }
  }
  return picture;
}

Image environment_picture(const std::string& file) {
  return file == studio_name ? studio_picture() : read_image(file);
}

std::shared_ptr<const ImagePyramid> environment_pyramid(const std::string& file) {
  if (file != studio_name) return load_pyramid(file);
  static const auto studio = std::make_shared<const ImagePyramid>(pyramid_of(studio_picture(), columns));
  return studio;
}

}  // namespace quadgraph
