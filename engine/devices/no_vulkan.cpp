#include "engine/base/error.h"
#include "engine/devices/vulkan.h"

namespace quadgraph {

std::shared_ptr<device::Device> open_vulkan(const device::DeviceOptions& options) {
  throw DeviceError("there is no device '" + options.device +
                    "' but cpu alone, as this build has no Vulkan (tools/setup --vulkan builds it with)");
}

}  // namespace quadgraph
