#include "engine/render/picture/surroundings.h"

#include <algorithm>
#include <cmath>

#include "engine/device/commands.h"
#include "engine/render/light/studio.h"
#include "interface/display/surroundings.comp.h"

namespace quadgraph {

Surroundings::Surroundings(device::Device& device) : device_(device), pass_(device, shader::surroundings) {}

const Surroundings::Seen& Surroundings::seen(const std::string& file) {
  auto image = environment_pyramid(file);
  Seen& known = seen_[file];
  if (known.image == image) return known;
  known.texels = device::upload<glm::vec3>(device_, image->texels, "picture/surroundings image");
  known.image = std::move(image);
  return known;
}

bool Surroundings::run(std::span<const Light> lights, const Camera& camera, PictureBuffers& picture, PassStats& pass) {
  const auto around = [](const Light& light) { return form_of(light.kind).image == LightImage::around; };
  std::erase_if(seen_, [&](const auto& known) {
    return std::none_of(lights.begin(), lights.end(), [&](const Light& l) { return l.file == known.first; });
  });
  if (std::none_of(lights.begin(), lights.end(), around)) return false;
  picture.make_room_around(device_);
  const glm::vec3 right = camera.slopes().x * camera.right, up = camera.slopes().y * camera.up;
  device::Commands commands(device_, 1);
  commands.begin_pass("surroundings");
  bool first = true;
  for (const Light& light : lights) {
    if (!around(light)) continue;
    const Seen& image = seen(light.file);
    const glm::mat3 into = glm::transpose(environment_frame(light));
    const gpu::SurroundingsPush push{.texels = image.texels.address(),
                                     .surroundings = picture.around.address(),
                                     .image = {0, image.image->columns, image.image->rows, image.image->levels},
                                     .corner = into * (up - right + camera.ahead),
                                     .right = into * (2.0f * right),
                                     .down = into * (-2.0f * up),
                                     .power = light.power,
                                     .width = picture.width,
                                     .height = picture.height,
                                     .first = first ? 1u : 0u};
    commands.dispatch(pass_, push, picture.pixels());
    first = false;
  }
  commands.end_pass();
  pass = {"surroundings", commands.submit_and_wait()[0].time_ms, sizeof(glm::vec3) * picture.pixels(), 1};
  return true;
}

}  // namespace quadgraph
