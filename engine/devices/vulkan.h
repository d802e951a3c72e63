// Vulkan devices, of a build that has them.
#pragma once

#include <memory>

#include "engine/device/device.h"

namespace quadgraph {

// Throws DeviceError where there is none that the options mean, or the build has no Vulkan.
std::shared_ptr<device::Device> open_vulkan(const device::DeviceOptions& options);

}  // namespace quadgraph
