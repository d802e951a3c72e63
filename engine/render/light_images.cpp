#include "engine/render/light_images.h"

#include <algorithm>
#include <utility>

#include "engine/graph/error.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t largest_projected = 4096;  // texels a side; beyond, no face or pixel sees them apart

ProjectedImage upload_projected(vk::Context& context, const Image& picture) {
  Image level = picture;
  while (std::max(level.width, level.height) > largest_projected) {
    level = resampled(level, std::max(level.width / 2, 1u), std::max(level.height / 2, 1u));
  }
  ProjectedImage image{{}, level.width, level.height, 1};
  std::vector<glm::vec3> texels = level.texels;
  while (level.width > 1 || level.height > 1) {
    level = resampled(level, std::max(level.width / 2, 1u), std::max(level.height / 2, 1u));
    texels.insert(texels.end(), level.texels.begin(), level.texels.end());
    ++image.levels;
  }
  image.texels = vk::upload<glm::vec3>(context, texels, "light/projected image");
  return image;
}

}  // namespace

void LightImages::load(std::span<const Light> lights) {
  std::map<std::string, Loaded<ProjectedImage>> projected;
  for (const Light& light : lights) {
    if (light.kind != LightKind::projector || projected.contains(light.file)) continue;
    std::error_code missing;
    const auto changed = std::filesystem::last_write_time(light.file, missing);
    const auto found = projected_.find(light.file);
    if (!missing && found != projected_.end() && found->second.changed == changed) {
      projected.insert(projected_.extract(found));
      continue;
    }
    try {
      projected.emplace(light.file,
                        Loaded<ProjectedImage>{changed, upload_projected(context_, read_image(light.file))});
    } catch (const InputError& error) {
      throw InputError("light '" + to_string(light) + "', file: " + error.what());
    }
  }
  projected_ = std::move(projected);
}

}  // namespace quadgraph
