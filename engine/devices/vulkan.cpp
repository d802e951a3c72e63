#include "engine/devices/vulkan.h"

#include "engine/vk/context.h"

namespace quadgraph {

std::shared_ptr<device::Device> open_vulkan(const device::DeviceOptions& options) {
  return std::make_shared<vk::Context>(options);
}

std::vector<vk::Surveyed> survey_vulkan() {
  return vk::survey();
}

}  // namespace quadgraph
