#include "engine/vk/physical_device.h"

#include <algorithm>
#include <cstring>

#include "engine/vk/features.h"
#include "engine/vk/handle.h"

namespace quadgraph::vk {
namespace {

bool can_swap(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "vkEnumerateDeviceExtensionProperties");
  std::vector<VkExtensionProperties> extensions(count);
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data()),
        "vkEnumerateDeviceExtensionProperties");
  return named(extensions, VK_KHR_SWAPCHAIN_EXTENSION_NAME);
}

}  // namespace

VkApplicationInfo application_info() {
  VkApplicationInfo application{};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.pApplicationName = "quadgraph";
  application.apiVersion = VK_API_VERSION_1_3;
  return application;
}

bool named(const std::vector<VkExtensionProperties>& extensions, const char* name) {
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
  std::uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> devices(count);
  check(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "vkEnumeratePhysicalDevices");
  return devices;
}

std::optional<std::uint32_t> find_family(VkPhysicalDevice device, VkSurfaceKHR surface) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  constexpr VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (std::uint32_t family = 0; family < count; ++family) {
    VkBool32 presents = VK_TRUE;
    if (surface != VK_NULL_HANDLE) {
      check(vkGetPhysicalDeviceSurfaceSupportKHR(device, family, surface, &presents),
            "vkGetPhysicalDeviceSurfaceSupportKHR");
    }
    if ((families[family].queueFlags & wanted) == wanted && presents == VK_TRUE) return family;
  }
  return std::nullopt;
}

Identity::Identity(VkPhysicalDevice device, void* more) {
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  driver.pNext = more;
  all.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  all.pNext = &driver;
  vkGetPhysicalDeviceProperties2(device, &all);
}

std::string Identity::driver_text() const {
  return std::string(driver.driverName) + " " + driver.driverInfo;
}

int preference(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    default:
      return 3;
  }
}

std::string what_is_missing(VkPhysicalDevice device, VkSurfaceKHR surface) {
  const Identity identity(device);
  if (identity.device().apiVersion < VK_API_VERSION_1_3) return "Vulkan 1.3";
  // Chromium 156's crashes in vkCreateComputePipelines of 30 of the first 50 shaders, assemble_even among them.
  if (identity.driver.driverID == VK_DRIVER_ID_GOOGLE_SWIFTSHADER)
    return "a compiler of shaders that does not crash on them";
  Features features;
  vkGetPhysicalDeviceFeatures2(device, &features.base);
  const std::string lacks = lacking(features, identity.device().limits);
  if (!lacks.empty()) return lacks;
  for (const RequiredFormat& required : required_formats) {
    VkFormatProperties format;
    vkGetPhysicalDeviceFormatProperties(device, required.format, &format);
    if ((format.optimalTilingFeatures & required.use) != required.use) {
      return std::string("images of ") + required.name + " to draw into";
    }
  }
  if (surface != VK_NULL_HANDLE && !can_swap(device)) return VK_KHR_SWAPCHAIN_EXTENSION_NAME;
  if (!find_family(device, VK_NULL_HANDLE)) return "a queue that both draws and computes";
  return find_family(device, surface) ? "" : "a queue that draws, computes and presents to this window";
}

}  // namespace quadgraph::vk
