#include "engine/vk/features.h"

namespace quadgraph::vk {

Features::Features() {
  v13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
  v12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  base.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  base.pNext = &v12;
  v12.pNext = &v13;
}

std::vector<std::pair<const char*, VkBool32*>> Features::required() {
  return {
      // Shaders: arrays by address; structs laid out as in C++; workgroups of a specialised size.
      {"bufferDeviceAddress", &v12.bufferDeviceAddress},
      {"scalarBlockLayout", &v12.scalarBlockLayout},
      {"maintenance4", &v13.maintenance4},
      // Calls: vkCmdBeginRendering; vkCmdPipelineBarrier2 and vkQueueSubmit2; vkResetQueryPool.
      {"dynamicRendering", &v13.dynamicRendering},
      {"synchronization2", &v13.synchronization2},
      {"hostQueryReset", &v12.hostQueryReset},
  };
}

}  // namespace quadgraph::vk
