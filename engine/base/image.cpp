#include "engine/base/image.h"

#include <algorithm>

namespace quadgraph {
namespace {

Image halved(const Image& picture) {
  return resampled(picture, std::max(picture.width / 2, 1u), std::max(picture.height / 2, 1u));
}

}  // namespace

Image resampled(const Image& picture, std::uint32_t width, std::uint32_t height) {
  const auto shrink = [](const Image& from, std::uint32_t to, bool rows) {
    const std::uint32_t size = rows ? from.height : from.width, across = rows ? from.width : from.height;
    Image image{rows ? from.width : to, rows ? to : from.height, {}};
    image.texels.assign(std::size_t{to} * across, glm::vec3(0));
    for (std::uint32_t i = 0; i < to; ++i) {
      const double begin = static_cast<double>(i) * size / to, end = static_cast<double>(i + 1) * size / to;
      for (auto k = static_cast<std::uint32_t>(begin); k < size && k < end; ++k) {
        const double part = std::min<double>(end, k + 1) - std::max<double>(begin, k);
        const auto share = static_cast<float>(part / (end - begin));
        for (std::uint32_t j = 0; j < across; ++j) {
          image.texels[rows ? std::size_t{i} * across + j : std::size_t{j} * to + i] +=
              share * from.texels[rows ? std::size_t{k} * across + j : std::size_t{j} * size + k];
        }
      }
    }
    return image;
  };
  return shrink(shrink(picture, height, true), width, false);
}

ImagePyramid pyramid_of(Image picture, std::uint32_t largest) {
  while (std::max(picture.width, picture.height) > largest) picture = halved(picture);
  ImagePyramid pyramid{{}, picture.width, picture.height, 1, picture.texels};
  while (picture.width > 1 || picture.height > 1) {
    picture = halved(picture);
    pyramid.texels.insert(pyramid.texels.end(), picture.texels.begin(), picture.texels.end());
    ++pyramid.levels;
  }
  return pyramid;
}

}  // namespace quadgraph
