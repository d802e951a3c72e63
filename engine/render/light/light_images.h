// The images that lights are made of, on the device; each file is read once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "engine/device/memory.h"
#include "engine/optics/optical_surface.h"
#include "engine/render/light/environment.h"
#include "engine/render/light/image_file.h"
#include "engine/render/light/lights.h"

namespace quadgraph {

// Levels as gpu::LightShape says.
struct ProjectedImage {
  device::Buffer texels;
  std::uint32_t columns = 0, rows = 0, levels = 0;
};

// Pictures as shaders/light/render_shared.h says (ENVIRONMENT_*).
struct EnvironmentImage {
  Environment environment;
  std::vector<glm::vec3> pictures;
  device::Buffer texels;  // the same
  // What the pictures are for, 0 where there is none yet: from ENVIRONMENT_ENTERING on, and those before.
  std::vector<OpticalSurface> surfaces{};
  float roughness = 0, placed_roughness = 0, coat_roughness = 0;
};

class LightImages {
 public:
  explicit LightImages(device::Device& device) : device_(device) {}

  // Reads the files that `lights` name and that have not been read or have changed since, and forgets all others.
  // Throws InputError naming the light.
  void load(std::span<const Light> lights);

  // The image of a light that was given to the last `load`.
  const ProjectedImage& projected(const std::string& file) const { return projected_.at(file).image; }
  const EnvironmentImage& environment(const std::string& file) const { return environments_.at(file).image; }

  // Brings the pictures of environments up to date that depend on surfaces, each given once; on the roughness of the
  // surface, on that where an image says so, 0 without one, and on that of a coat, 0 without one.
  void set_surfaces(std::span<const OpticalSurface> surfaces);
  void set_roughness(float roughness, float placed, float coat);

 private:
  template <typename T>
  struct Loaded {
    std::filesystem::file_time_type changed;
    T image;
  };

  template <typename T>
  using Images = std::map<std::string, Loaded<T>>;

  template <typename T, typename Read, typename Upload>
  void load(const Light& light, Images<T>& old, Images<T>& images, const Read& read, const Upload& upload);

  device::Device& device_;
  Images<ProjectedImage> projected_;
  Images<EnvironmentImage> environments_;
};

}  // namespace quadgraph
