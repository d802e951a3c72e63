#include "engine/vk/survey.h"

#include <vulkan/vulkan.h>

#include <algorithm>
#include <memory>

#include "engine/vk/handle.h"
#include "engine/vk/physical_device.h"

namespace quadgraph::vk {
namespace {

VkPhysicalDeviceType type_of(VkPhysicalDevice device) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device, &properties);
  return properties.deviceType;
}

Surveyed surveyed(VkPhysicalDevice device) {
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = &driver;
  vkGetPhysicalDeviceProperties2(device, &properties);
  return {properties.properties.deviceName, std::string(driver.driverName) + " " + driver.driverInfo,
          properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU, what_is_missing(device, VK_NULL_HANDLE)};
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
