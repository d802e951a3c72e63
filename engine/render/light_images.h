// The images that lights are made of, on the device; each file is read once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "engine/render/image_file.h"
#include "engine/render/lights.h"
#include "engine/vk/memory.h"

namespace quadgraph {

// Levels as gpu::LightShape says.
struct ProjectedImage {
  vk::Buffer texels;
  std::uint32_t columns = 0, rows = 0, levels = 0;
};

class LightImages {
 public:
  explicit LightImages(vk::Context& context) : context_(context) {}

  // Reads the files that `lights` name and that have not been read or have changed since, and forgets all others.
  // Throws InputError naming the light.
  void load(std::span<const Light> lights);

  // Of a light given to the last `load`.
  const ProjectedImage& projected(const std::string& file) const { return projected_.at(file).image; }

 private:
  template <typename T>
  struct Loaded {
    std::filesystem::file_time_type changed;
    T image;
  };

  vk::Context& context_;
  std::map<std::string, Loaded<ProjectedImage>> projected_;
};

}  // namespace quadgraph
