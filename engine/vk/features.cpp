#include "engine/vk/features.h"

#include "engine/device/device.h"

namespace quadgraph::vk {
namespace {

// A limit that must be above what Vulkan 1.3 guarantees.
struct RequiredLimit {
  const char* name;
  std::uint32_t least;
  std::uint32_t (*of)(const VkPhysicalDeviceLimits&);
};

// Sums over a workgroup are written for 256 invocations; 128 are guaranteed.
constexpr std::uint32_t group = device::ComputeOptions{}.workgroup_size;
constexpr RequiredLimit required_limits[] = {
    {"maxComputeWorkGroupInvocations", group, [](const auto& limits) { return limits.maxComputeWorkGroupInvocations; }},
    {"maxComputeWorkGroupSize[0]", group, [](const auto& limits) { return limits.maxComputeWorkGroupSize[0]; }}};

}  // namespace

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

// Samples of a picture and what shadow maps hold. Of depths in 32 and in 24 bits Vulkan guarantees one.
const std::array<RequiredFormat, 2> required_formats = {
    {{"R32G32B32A32_SFLOAT", VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT},
     {"D32_SFLOAT", VK_FORMAT_D32_SFLOAT, VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT}}};

std::string lacking(Features& features, const VkPhysicalDeviceLimits& limits) {
  for (const auto& [name, value] : features.required()) {
    if (*value == VK_FALSE) return name;
  }
  for (const RequiredLimit& limit : required_limits) {
    const std::uint32_t has = limit.of(limits);
    if (has < limit.least) {
      return std::string(limit.name) + " of " + std::to_string(limit.least) + " (it allows " + std::to_string(has) +
             ")";
    }
  }
  return {};
}

}  // namespace quadgraph::vk
