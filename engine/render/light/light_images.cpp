#include "engine/render/light/light_images.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/render/light/studio.h"
#include "shaders/light/render_shared.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t largest_projected = 4096;  // texels a side; beyond, no face or pixel sees them apart

ProjectedImage upload_projected(device::Device& device, Image&& picture) {
  const ImagePyramid pyramid = pyramid_of(std::move(picture), largest_projected);
  return {device::upload<glm::vec3>(device, pyramid.texels, "light/projected image"), pyramid.columns, pyramid.rows,
          pyramid.levels};
}

constexpr std::size_t picture_texels = std::size_t{gpu::ENVIRONMENT_COLUMNS} * gpu::ENVIRONMENT_ROWS;
// Beyond this degree irradiance has nothing left: docs/lights.md.
constexpr int irradiance_degree = 8;

void write_picture(device::Device& device, EnvironmentImage& image, std::uint32_t number,
                   std::span<const double> degrees) {
  const auto picture =
      sphere_picture(image.environment.series, degrees, gpu::ENVIRONMENT_COLUMNS, gpu::ENVIRONMENT_ROWS);
  std::copy(picture.begin(), picture.end(),
            image.pictures.begin() + static_cast<std::ptrdiff_t>(number * picture_texels));
  device::write_bytes(device, image.texels, std::as_bytes(std::span(image.pictures)));
}

// Room for so many pictures, of which those that are there stay.
void make_room(device::Device& device, EnvironmentImage& image, std::size_t pictures) {
  if (image.texels.size() == pictures * picture_texels * sizeof(glm::vec3)) return;
  image.pictures.resize(pictures * picture_texels);
  image.texels = device::upload<glm::vec3>(device, image.pictures, "light/environment");
}

EnvironmentImage upload_environment(device::Device& device, Image&& picture) {
  EnvironmentImage image{
      environment_of(std::move(picture)), std::vector<glm::vec3>((gpu::ENVIRONMENT_ENTERING + 1) * picture_texels), {}};
  image.texels = {device, image.pictures.size() * sizeof(glm::vec3), device::Place::device, "light/environment"};
  write_picture(device, image, gpu::ENVIRONMENT_RAYS, ray_degrees(environment_degree));
  return image;
}

// Brings picture `number` up to date: `known` is what it was made for, nothing while it is written, as that may be
// given up half-way.
template <typename Known, typename Degrees>
void renew_picture(device::Device& device, EnvironmentImage& image, std::uint32_t number, Known& known,
                   const Known& wanted, const Degrees& degrees) {
  if (known == wanted) return;
  known = 0;
  write_picture(device, image, number, degrees(wanted));
  known = wanted;
}

}  // namespace

template <typename T, typename Read, typename Upload>
void LightImages::load(const Light& light, Images<T>& old, Images<T>& images, const Read& read, const Upload& upload) {
  if (images.contains(light.file)) return;
  std::error_code missing;
  const auto changed = std::filesystem::last_write_time(light.file, missing);
  const auto found = old.find(light.file);
  if ((!missing || light.file == studio_name) && found != old.end() && found->second.changed == changed) {
    images.insert(old.extract(found));
    return;
  }
  try {
    images.emplace(light.file, Loaded<T>{changed, upload(device_, read(light.file))});
  } catch (const InputError& error) {
    throw InputError("light '" + to_string(light) + "', file: " + error.what());
  }
}

void LightImages::load(std::span<const Light> lights) {
  Images<ProjectedImage> projected;
  Images<EnvironmentImage> environments;
  for (const Light& light : lights) {
    const LightImage image = form_of(light.kind).image;
    if (image == LightImage::projected) load(light, projected_, projected, read_image, upload_projected);
    if (image == LightImage::around) {
      load(light, environments_, environments, environment_picture, upload_environment);
    }
  }
  projected_ = std::move(projected);
  environments_ = std::move(environments);
}

void LightImages::set_surfaces(std::span<const OpticalSurface> surfaces) {
  const auto entering = [](const OpticalSurface& surface) { return irradiance_degrees(surface, irradiance_degree); };
  for (auto& [file, loaded] : environments_) {
    EnvironmentImage& image = loaded.image;
    make_room(device_, image, gpu::ENVIRONMENT_ENTERING + surfaces.size());
    image.surfaces.resize(surfaces.size(), 0.0);
    for (std::uint32_t i = 0; i < surfaces.size(); ++i) {
      renew_picture(device_, image, gpu::ENVIRONMENT_ENTERING + i, image.surfaces[i], surfaces[i], entering);
    }
  }
}

void LightImages::set_roughness(float roughness, float placed, float coat) {
  const auto write = [&](EnvironmentImage& image, std::uint32_t number, float& known, float wanted) {
    const auto reflected = [](float of) { return reflection_degrees(of, environment_degree); };
    if (wanted != 0) renew_picture(device_, image, number, known, wanted, reflected);
  };
  for (auto& [file, loaded] : environments_) {
    write(loaded.image, gpu::ENVIRONMENT_REFLECTED, loaded.image.roughness, roughness);
    write(loaded.image, gpu::ENVIRONMENT_REFLECTED_PLACED, loaded.image.placed_roughness, placed);
    write(loaded.image, gpu::ENVIRONMENT_COATED, loaded.image.coat_roughness, coat);
  }
}

}  // namespace quadgraph
