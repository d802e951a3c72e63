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

// A warm one behind the object, to the left, as large as it is strong, which shows what comes through thin parts and
// gives them rims; a narrow cool strip to the right; one above the camera, which is reflected in front; and a faint
// backdrop, which is seen through what is clear.
constexpr std::array<SoftBox, 4> boxes = {{{-36, 30, 60, 56, {28.0f, 22.0f, 15.0f}},
                                           {90, 25, 18, 90, {11.0f, 13.0f, 16.0f}},
                                           {-145, 42, 60, 46, {5.0f, 5.0f, 5.0f}},
                                           {25, 6, 110, 32, {1.4f, 1.3f, 1.2f}}}};
constexpr glm::vec3 floor_radiance{0.04f}, wall_radiance{0.02f}, ceiling_radiance{0.03f};

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
