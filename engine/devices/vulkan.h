// Vulkan devices, of a build that has them.
#pragma once

#include <memory>
#include <vector>

#include "engine/device/device.h"
#include "engine/vk/survey.h"

namespace quadgraph {

// Throws DeviceError where there is none that the options mean, or the build has no Vulkan.
std::shared_ptr<device::Device> open_vulkan(const device::DeviceOptions& options);

// Those that there are, the preferred ones first. Throws DeviceError where Vulkan finds none, or the build has none.
std::vector<vk::Surveyed> survey_vulkan();

}  // namespace quadgraph
