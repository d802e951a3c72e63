#include "engine/base/error.h"
#include "engine/devices/vulkan.h"

namespace quadgraph {

std::shared_ptr<device::Device> open_vulkan(const device::DeviceOptions& options) {
  throw DeviceError("no device '" + options.device +
                    "': this build has no Vulkan, so cpu is the only one (tools/setup --vulkan adds it)");
}

std::vector<vk::Surveyed> survey_vulkan() {
  throw DeviceError("this build has no Vulkan (tools/setup --vulkan adds it)");
}

}  // namespace quadgraph
