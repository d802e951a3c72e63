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

// What a device and its driver call themselves. `more`: structures to fill with it.
struct Identity {
  VkPhysicalDeviceDriverProperties driver{};
  VkPhysicalDeviceProperties2 all{};

  explicit Identity(VkPhysicalDevice device, void* more = nullptr);
  Identity(const Identity&) = delete;
  Identity& operator=(const Identity&) = delete;

  const VkPhysicalDeviceProperties& device() const { return all.properties; }
  std::string driver_text() const;  // name and version
  bool software() const { return device().deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
};

// Of several devices that with the least is taken: discrete GPUs first, software last.
int preference(VkPhysicalDeviceType type);

}  // namespace quadgraph::vk
