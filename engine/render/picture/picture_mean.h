// The mean of pictures of the same size: each is one frame of what they make together.
#pragma once

#include <cstdint>

#include "engine/base/pass_stats.h"
#include "engine/device/pipeline.h"
#include "engine/render/picture/picture_buffers.h"

namespace quadgraph {

class PictureMean {
 public:
  explicit PictureMean(device::Device& device);

  // Frames come in their order, `index` from 0 on, which begins anew. All of a picture is averaged, its doubt too.
  PassStats add(const PictureBuffers& frame, std::uint32_t index);

  // Of the frames so far.
  const PictureBuffers& picture() const { return picture_; }

 private:
  device::Device& device_;
  device::ComputePass pass_;
  PictureBuffers picture_;
};

}  // namespace quadgraph
