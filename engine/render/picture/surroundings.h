// What lies around the body, behind it in a picture.
#pragma once

#include <map>
#include <span>
#include <string>

#include "engine/base/pass_stats.h"
#include "engine/device/pipeline.h"
#include "engine/render/display/camera.h"
#include "engine/render/light/light_set.h"
#include "engine/render/picture/picture_buffers.h"

namespace quadgraph {

class Surroundings {
 public:
  explicit Surroundings(device::Device& device);

  // Writes picture.surroundings, the sum of all environment lights as sharp as their files are; false, and nothing, if
  // there is none. Throws InputError as read_image.
  bool run(std::span<const Light> lights, const Camera& camera, PictureBuffers& picture, PassStats& pass);

 private:
  struct Seen {
    std::shared_ptr<const ImagePyramid> image;
    device::Buffer texels;
  };

  const Seen& seen(const std::string& file);

  device::Device& device_;
  device::ComputePass pass_;
  std::map<std::string, Seen> seen_;
};

}  // namespace quadgraph
