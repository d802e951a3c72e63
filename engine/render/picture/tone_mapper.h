// What a screen shows of a picture, made where the picture is.
#pragma once

#include <cstdint>

#include "engine/device/pipeline.h"
#include "engine/render/picture/picture_buffers.h"
#include "engine/render/picture/tone_map.h"

namespace quadgraph {

// Where a picture goes.
struct ScreenPart {
  std::uint32_t width = 0, height = 0;  // pixels; the picture is stretched to them
  bool blue_first = false;              // B8G8R8A8 instead of R8G8B8A8
};

class ToneMapper {
 public:
  explicit ToneMapper(device::Device& device);

  // The stops of exposure_of, within 1/128 of one.
  float exposure(const PictureBuffers& picture, const ToneOptions& options);

  // Four bytes per pixel of the part, row after row; to_srgb8 within one code. Kept until the next call.
  const device::Buffer& run(const PictureBuffers& picture, const ToneOptions& options, float exposure_stops,
                            const ScreenPart& part);

 private:
  device::Device& device_;
  device::ComputePass luminance_, tone_map_;
  device::Buffer bins_, with_, bins_on_host_, pixels_;
};

}  // namespace quadgraph
