#include "engine/vk/survey.h"

#include <vulkan/vulkan.h>

#include <algorithm>
#include <memory>

#include "engine/vk/handle.h"
#include "engine/vk/physical_device.h"

namespace quadgraph::vk {
namespace {

VkPhysicalDeviceType type_of(VkPhysicalDevice device) {
  return Identity(device).device().deviceType;
}

Surveyed surveyed(VkPhysicalDevice device) {
  const Identity identity(device);
  return {identity.device().deviceName, identity.driver_text(), identity.software(),
          what_is_missing(device, VK_NULL_HANDLE)};
}

}  // namespace

std::vector<Surveyed> survey() {
  const VkApplicationInfo application = application_info();
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &application;
  VkInstance made = VK_NULL_HANDLE;
  check(vkCreateInstance(&info, nullptr, &made), "vkCreateInstance");
  const auto destroy = [](VkInstance instance) { vkDestroyInstance(instance, nullptr); };
  const std::unique_ptr<VkInstance_T, decltype(destroy)> instance(made, destroy);
  std::vector<VkPhysicalDevice> devices = physical_devices(made);
  std::stable_sort(devices.begin(), devices.end(), [](VkPhysicalDevice a, VkPhysicalDevice b) {
    return preference(type_of(a)) < preference(type_of(b));
  });
  std::vector<Surveyed> found;
  for (VkPhysicalDevice device : devices) found.push_back(surveyed(device));
  return found;
}

}  // namespace quadgraph::vk
