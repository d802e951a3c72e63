// Files of pictures that lights, edits and surfaces are made of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "engine/base/image.h"

namespace quadgraph {

// Reads .exr (channels R, G, B, or Y), Radiance .hdr, or .png (decoded from its gamma; alpha is left out), of at most
// 16384 texels a side. Values below 0 count as 0. Throws InputError naming the file, what was found and what is
// allowed.
Image read_image(const std::filesystem::path& path);

// The values of a .png from 0 to 1 as they stand, 8 bits of them, alpha apart. Throws as read_image.
Image read_png_values(const std::filesystem::path& path);

inline constexpr std::uint32_t largest_kept = 2048;  // texels a side, of pyramids

// The pyramid of an image file, at most 2048 texels a side; from memory if the file has not changed since it was read.
// Throws as read_image.
std::shared_ptr<const ImagePyramid> load_pyramid(const std::filesystem::path& path);

// The parts of read_image.
Image read_exr(const std::filesystem::path& path);
// At most three, as components of the texels; nothing where one is not there. Values and errors as of read_image.
std::optional<Image> read_exr_channels(const std::filesystem::path& path, std::span<const std::string> names);
Image read_hdr(const std::filesystem::path& path);
Image read_png(const std::filesystem::path& path);

// Throws InputError unless the sides are 1 to 16384 texels.
void check_image_size(const std::filesystem::path& path, std::int64_t width, std::int64_t height);

}  // namespace quadgraph
