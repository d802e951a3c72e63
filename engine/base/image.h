// Pictures that lights, edits and surfaces are made of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <vector>

namespace quadgraph {

// Linear RGB, row after row, the top one first; finite and >= 0.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec3> texels;
};

// The picture in another size, every texel the mean over its area.
Image resampled(const Image& picture, std::uint32_t width, std::uint32_t height);

// A picture and smaller ones of it, one after the other as shaders/shared/image_levels.h says.
struct ImagePyramid {
  std::filesystem::path file{};  // where it is from; empty if from nowhere
  std::uint32_t columns = 0, rows = 0, levels = 0;
  std::vector<glm::vec3> texels{};
};

// The pyramid of an image, which is halved first until no side is longer than `largest` texels.
ImagePyramid pyramid_of(Image picture, std::uint32_t largest);

}  // namespace quadgraph
