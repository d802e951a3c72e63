// libvulkan, which no program links: it is opened at the first call of a function of Vulkan (loader.cpp).
#pragma once

namespace quadgraph::vk {

// Throws DeviceError, naming what to install, where there is no libvulkan.so.1. So does any first call.
void require_loader();

}  // namespace quadgraph::vk
