// A rendered picture in linear radiance, and its files.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/reference/error_estimate.h"
#include "engine/render/picture/convergence.h"
#include "engine/render/picture/tone_map.h"

namespace quadgraph {

// Row after row, the top one first. Radiance is premultiplied by alpha, as in EXR.
struct Picture {
  std::uint32_t width = 0, height = 0;
  // RGB per pixel, W/(mm^2 sr): light that was scattered in the body (the published source may leave it slightly
  // negative), that the surface reflected, and that crossed the body without being scattered. They add up to the
  // picture.
  std::vector<float> scattered, specular, unscattered;
  std::vector<float> transmittance;   // RGB per pixel: share of what is behind the body that is seen through it
  std::vector<float> alpha;           // per pixel, share of the pixel that the object covers
  std::vector<float> surroundings{};  // RGB per pixel, W/(mm^2 sr): what is behind; empty: only a backdrop
  std::optional<ErrorEstimate>
      error{};  // of scattered light, where it is known (engine/render/picture/picture_error.h)
  // RGB per pixel: of the sum of the layers; empty where it is not known (engine/render/picture/picture_noise.h).
  std::vector<float> standard_error{};
  std::optional<Convergence> convergence{};  // where an error was asked for
  bool false_colour = false;  // the layer `scattered` is not radiance but linear display colour, shown as it is

  // The sum of the three layers at a value (pixel and channel), what is negative counting as none.
  float radiance(std::size_t value) const {
    return std::max(scattered[value], 0.0f) + specular[value] + unscattered[value];
  }
};

// Name and value of everything needed to make the picture again and to judge it.
using Metadata = std::vector<std::pair<std::string, std::string>>;

// 8-bit sRGB RGB rows, tone mapped and laid over the surroundings, or the background.
std::vector<std::uint8_t> to_srgb8(const Picture& picture, const ToneOptions& options);

// The same of the object alone, as RGBA rows with straight alpha: what is seen through it is transparent too.
std::vector<std::uint8_t> to_srgba8(const Picture& picture, const ToneOptions& options);

// Both write a temporary file beside `path` and rename it, and add to the metadata "exposure", the stops that to_srgb8
// applies, "tone" and "white balance". Throw InputError naming the file.
// PNG: to_srgb8, or to_srgba8 where the background is transparent; metadata as tEXt.
void write_png(const std::filesystem::path& path, const Picture& picture, const ToneOptions& options,
               const Metadata& metadata);

// EXR: float32 linear and not exposed, channels R, G, B (the sum of the layers), A, and R, G, B of the layers
// scattered, specular, unscattered and transmittance, and of the surroundings and the standard error if there are any;
// metadata as string attributes.
void write_exr(const std::filesystem::path& path, const Picture& picture, const ToneOptions& options,
               const Metadata& metadata);

}  // namespace quadgraph
