// What the engine requires of a device beyond Vulkan 1.3 itself, and enables: no more than compiled shaders and the
// calls of vk/ need, so that no device is refused without a reason (tests/cpp/vk/features_test.cpp).
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace quadgraph::vk {

// Chained, so that one call queries or enables them all. All are off at first.
struct Features {
  VkPhysicalDeviceVulkan13Features v13{};
  VkPhysicalDeviceVulkan12Features v12{};
  VkPhysicalDeviceFeatures2 base{};

  Features();
  Features(const Features&) = delete;
  Features& operator=(const Features&) = delete;

  // By the names that Vulkan gives them.
  std::vector<std::pair<const char*, VkBool32*>> required();
};

// An image that is drawn into.
struct RequiredFormat {
  const char* name;
  VkFormat format;
  VkFormatFeatureFlags use;
};

extern const std::array<RequiredFormat, 2> required_formats;

// The first of what is required that a device does not have; empty where it has all. features: as queried.
std::string lacking(Features& features, const VkPhysicalDeviceLimits& limits);

}  // namespace quadgraph::vk
