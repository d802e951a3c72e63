// Pictures that lights are made of.
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

// Reads .exr (channels R, G, B, or Y), Radiance .hdr, or .png (decoded from its gamma; alpha is left out), of at most
// 16384 texels a side. Values below 0 count as 0. Throws InputError naming the file, what was found and what is
// allowed.
Image read_image(const std::filesystem::path& path);

// The picture in another size, every texel the mean over its area.
Image resampled(const Image& picture, std::uint32_t width, std::uint32_t height);

// The parts of read_image.
Image read_exr(const std::filesystem::path& path);
Image read_hdr(const std::filesystem::path& path);
Image read_png(const std::filesystem::path& path);

// Throws InputError unless the sides are 1 to 16384 texels.
void check_image_size(const std::filesystem::path& path, std::int64_t width, std::int64_t height);

}  // namespace quadgraph
