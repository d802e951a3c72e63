// Physical devices of Vulkan, and what the engine wants of one.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace quadgraph::vk {

// What an instance is told of this program.
VkApplicationInfo application_info();

bool named(const std::vector<VkExtensionProperties>& extensions, const char* name);

// All that an instance finds. Throws DeviceError.
std::vector<VkPhysicalDevice> physical_devices(VkInstance instance);

// The first family whose queues draw, compute and, where there is a surface, present to it.
std::optional<std::uint32_t> find_family(VkPhysicalDevice device, VkSurfaceKHR surface);

// Empty if the device can run the engine and, where there is a surface, show a window; else what it lacks.
std::string what_is_missing(VkPhysicalDevice device, VkSurfaceKHR surface);

// Of several devices that with the least is taken: discrete GPUs first, software last.
int preference(VkPhysicalDeviceType type);

}  // namespace quadgraph::vk
