#include "engine/render/light/normal_map_file.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/file/file_cache.h"
#include "engine/render/light/image_file.h"

namespace quadgraph {
namespace {

constexpr float steepest = 8;  // slope, 83 degrees

// Of a texel from 0 to 1.
glm::vec3 slopes_of(const glm::vec3& texel) {
  const glm::vec3 normal = 2.0f * texel - glm::vec3(1);
  if (normal.z <= 0) return glm::vec3(0);
  glm::vec2 slope = glm::vec2(normal) / normal.z;
  slope *= std::min(1.0f, steepest / std::max(glm::length(slope), steepest));
  return {slope, glm::dot(slope, slope)};
}

ImagePyramid read_slopes(const std::filesystem::path& path) {
  Image image = read_png_values(path);
  const auto inwards = std::ranges::count_if(image.texels, [](const glm::vec3& texel) { return texel.z <= 0.5f; });
  if (2 * static_cast<std::size_t>(inwards) > image.texels.size()) {
    throw InputError(path.string() + ": blue of " +
                     std::to_string(100 * inwards / static_cast<long>(image.texels.size())) +
                     "% of the texels found at or below the middle, which points into the surface; a normal map in "
                     "tangent space is wanted, most of which is light blue");
  }
  ImagePyramid slopes = pyramid_of(slopes_from(std::move(image)), largest_kept);
  slopes.file = path;
  return slopes;
}

}  // namespace

Image slopes_from(Image normals) {
  std::ranges::transform(normals.texels, normals.texels.begin(), slopes_of);
  return normals;
}

std::shared_ptr<const ImagePyramid> load_normal_map(const std::filesystem::path& path) {
  static FileCache<ImagePyramid> known(4);
  return known.load(
      path, [](const std::filesystem::path& file) { return std::make_shared<ImagePyramid>(read_slopes(file)); });
}

}  // namespace quadgraph
