#include "engine/device/commands.h"

#include "engine/base/error.h"

namespace quadgraph::device {

std::uint32_t Commands::checked_workgroups(const ComputePass& pass, std::uint64_t elements) const {
  const std::uint64_t groups = workgroups(elements, pass.workgroup_size());
  if (groups > device_.max_workgroups()) {
    throw DeviceError(pass.name() + " needs " + std::to_string(groups) + " workgroups, " + device_.info().name +
                      " allows " + std::to_string(device_.max_workgroups()));
  }
  return static_cast<std::uint32_t>(groups);
}

DrawImages Commands::images_of(const DrawTarget& target) {
  DrawImages images{{}, &target.depth->memory(), target.width, target.height};
  if (images.width == 0) images.width = target.depth->options().width;
  if (images.height == 0) images.height = target.depth->options().height;
  for (const Image* image : target.colours) images.colours.push_back(&image->memory());
  return images;
}

}  // namespace quadgraph::device
