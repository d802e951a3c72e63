#include "engine/render/picture/picture_mean.h"

#include <algorithm>

#include "engine/device/commands.h"
#include "interface/display/mean.comp.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t most_values = 1u << 23;  // of a dispatch: what every device takes

}  // namespace

PictureMean::PictureMean(device::Device& device) : device_(device), pass_(device, shader::mean) {}

PassStats PictureMean::add(const PictureBuffers& frame, std::uint32_t index) {
  picture_.resize(device_, frame.width, frame.height);
  picture_.has_doubt = frame.has_doubt;
  picture_.has_surroundings = frame.has_surroundings;
  picture_.false_colour = frame.false_colour;
  if (frame.has_doubt) picture_.make_room_doubt(device_);
  if (frame.has_surroundings) picture_.make_room_around(device_);
  std::uint64_t values = 0;
  device::Commands commands(device_, 1);
  commands.begin_pass("mean");
  const auto take = [&](const device::Buffer& from, const device::Buffer& to, std::uint64_t per_pixel) {
    const std::uint64_t count = per_pixel * frame.pixels();
    for (std::uint64_t first = 0; first < count; first += most_values) {
      const std::uint64_t part = std::min(most_values, count - first);
      commands.dispatch(pass_,
                        gpu::MeanPush{.frame = from.address() + sizeof(float) * first,
                                      .mean = to.address() + sizeof(float) * first,
                                      .count = static_cast<std::uint32_t>(part),
                                      .share = 1.0f / static_cast<float>(index + 1)},
                        part);
    }
    values += count;
  };
  for (std::size_t k = 0; k < PICTURE_LAYERS; ++k) take(frame.layers[k], picture_.layers[k], 3);
  take(frame.alpha, picture_.alpha, 1);
  if (frame.has_surroundings) take(frame.around, picture_.around, 3);
  if (frame.has_doubt) take(frame.doubt, picture_.doubt, sizeof(gpu::PixelDoubt) / sizeof(float));
  commands.end_pass();
  return {"mean", commands.submit_and_wait()[0].time_ms, (index > 0 ? 3 : 2) * sizeof(float) * values, 1};
}

}  // namespace quadgraph
