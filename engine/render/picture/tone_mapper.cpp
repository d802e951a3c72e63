#include "engine/render/picture/tone_mapper.h"

#include <cmath>
#include <glm/matrix.hpp>
#include <span>

#include "engine/device/commands.h"
#include "interface/display/luminance.comp.h"
#include "interface/display/tone_map.comp.h"
#include "shaders/display/display_shared.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t bin_bytes = sizeof(std::uint32_t) * 2 * gpu::LUMINANCE_BINS;

// The middle of the bin that holds the quantile, 0 for the first one.
double quantile_of(std::span<const std::uint32_t> bins) {
  std::uint64_t count = 0;
  for (const std::uint32_t bin : bins) count += bin;
  const auto rank = static_cast<std::uint64_t>(exposure_quantile * static_cast<double>(count));
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < bins.size() && count > 0; ++i) {
    below += bins[i];
    if (below <= rank) continue;
    return i == 0 ? 0 : std::exp2(gpu::LEAST_STOP + (static_cast<double>(i) + 0.5) / gpu::BINS_PER_STOP);
  }
  return 0;
}

float exposure_from(std::span<const std::uint32_t> bins, ToneCurve curve) {
  return exposure_for({quantile_of(bins.first(gpu::LUMINANCE_BINS)), quantile_of(bins.last(gpu::LUMINANCE_BINS))},
                      curve);
}

}  // namespace

ToneMapper::ToneMapper(device::Device& device)
    : device_(device),
      luminance_(device, shader::luminance),
      tone_map_(device, shader::tone_map),
      bins_(device, bin_bytes, device::Place::device, "screen/luminance"),
      with_(device, sizeof(gpu::ShownWith), device::Place::device, "screen/tone"),
      bins_on_host_(device, bin_bytes, device::Place::host, "screen/luminance, read back") {}

float ToneMapper::exposure(const PictureBuffers& picture, const ToneOptions& options) {
  if (options.exposure_stops) return *options.exposure_stops;
  if (picture.false_colour) return 0;
  const glm::mat3 balance = glm::transpose(white_balance(options.white_balance));
  gpu::LuminancePush push{.layers = {},
                          .alpha = picture.alpha.address(),
                          .bins = bins_.address(),
                          .red = balance[0],
                          .green = balance[1],
                          .blue = balance[2],
                          .count = static_cast<std::uint32_t>(picture.pixels())};
  for (std::size_t k = 0; k < PICTURE_LAYERS; ++k) push.layers[k] = picture.layers[k].address();
  const device::Interruptible scope(device_);
  device::Commands commands(device_);
  commands.fill(bins_, 0);
  commands.dispatch(luminance_, push, picture.pixels());
  commands.copy(bins_, bins_on_host_, bin_bytes);
  commands.submit_and_wait();
  return exposure_from(bins_on_host_.mapped_as<std::uint32_t>(), options.curve);
}

const device::Buffer& ToneMapper::run(const PictureBuffers& picture, const ToneOptions& options, float exposure_stops,
                                      const ScreenPart& part) {
  const std::uint64_t count = std::uint64_t{part.width} * part.height;
  if (pixels_.size() < 4 * count) pixels_ = device::Buffer(device_, 4 * count, device::Place::device, "screen/pixels");
  const gpu::ShownWith with{tone_transform(options, exposure_stops), options.background_top, options.background_bottom};
  device::write_bytes(device_, with_, std::as_bytes(std::span(&with, 1)));
  gpu::ToneMapPush push{.layers = {},
                        .alpha = picture.alpha.address(),
                        .surroundings = picture.around.address(),
                        .target = pixels_.address(),
                        .with = with_.address(),
                        .picture_width = picture.width,
                        .picture_height = picture.height,
                        .width = part.width,
                        .height = part.height,
                        .false_colour = picture.false_colour ? 1u : 0u,
                        .blue_first = part.blue_first ? 1u : 0u,
                        .surrounded = picture.has_surroundings ? 1u : 0u};
  for (std::size_t k = 0; k < PICTURE_LAYERS; ++k) push.layers[k] = picture.layers[k].address();
  const device::Interruptible scope(device_);
  device::Commands commands(device_);
  commands.dispatch(tone_map_, push, count);
  commands.submit_and_wait();
  return pixels_;
}

}  // namespace quadgraph
