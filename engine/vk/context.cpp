#include "engine/vk/context.h"

#include <algorithm>
#include <cctype>
#include <cstring>

#include "engine/base/error.h"
#include "engine/vk/commands.h"
#include "engine/vk/features.h"
#include "engine/vk/physical_device.h"

namespace quadgraph::vk {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool layer_present(const char* name) {
  std::uint32_t count = 0;
  check(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
  std::vector<VkLayerProperties> layers(count);
  check(vkEnumerateInstanceLayerProperties(&count, layers.data()), "vkEnumerateInstanceLayerProperties");
  return std::any_of(layers.begin(), layers.end(), [&](const auto& l) { return std::strcmp(l.layerName, name) == 0; });
}

bool extension_present(const char* name) {
  std::uint32_t count = 0;
  check(vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr), "vkEnumerateInstanceExtensionProperties");
  std::vector<VkExtensionProperties> extensions(count);
  check(vkEnumerateInstanceExtensionProperties(nullptr, &count, extensions.data()),
        "vkEnumerateInstanceExtensionProperties");
  return named(extensions, name);
}

std::string result_name(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of device memory";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "initialisation failed";
    case VK_ERROR_DEVICE_LOST:
      return "device lost";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "layer not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "extension not present";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "feature not present";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "no compatible Vulkan driver (Debian: mesa-vulkan-drivers has a software device)";
    case VK_TIMEOUT:
      return "timed out";
    default:
      return "VkResult " + std::to_string(static_cast<int>(result));
  }
}

// An instance that lives as long as the process. With the last one the loader unloads the drivers, and NVIDIA's was
// refused after a process had loaded it often enough.
void keep_drivers_loaded() {
  static const VkInstance kept = [] {
    VkInstanceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    VkInstance made = VK_NULL_HANDLE;
    return vkCreateInstance(&info, nullptr, &made) == VK_SUCCESS ? made : VK_NULL_HANDLE;
  }();
  static_cast<void>(kept);
}

}  // namespace

void check(VkResult result, std::string_view call) {
  if (result != VK_SUCCESS) throw DeviceError(std::string(call) + ": " + result_name(result));
}

Context::Context(const device::DeviceOptions& options) {
  try {
    create_instance(options);
    if (options.validation) create_messenger();
    if (options.surface) surface_ = options.surface->create(instance_);
    pick_device(options.device);
    read_properties();
    create_device();
  } catch (...) {
    destroy();
    throw;
  }
}

Context::~Context() {
  destroy();
}

void Context::finish_updates() noexcept {
  const std::unique_ptr<device::Recording> last = take_updates();
  if (!last) return;
  const device::Uninterrupted scope(*this);
  try {
    last->submit_and_wait(nullptr);
  } catch (const DeviceError&) {  // a device that is lost; what comes next says so
  }
}

std::unique_ptr<RecordingParts> Context::take_parts(std::uint32_t queries) {
  const auto fits = [&](const auto& parts) { return parts->query_count >= queries; };
  const auto found = std::find_if(idle_.begin(), idle_.end(), fits);
  if (found == idle_.end()) return std::make_unique<RecordingParts>(*this, queries);
  std::unique_ptr<RecordingParts> taken = std::move(*found);
  idle_.erase(found);
  return taken;
}

void Context::give_back(std::unique_ptr<RecordingParts> parts) noexcept {
  idle_.push_back(std::move(parts));
}

void Context::destroy() noexcept {
  drop_transfers();
  idle_.clear();
  if (device_ != VK_NULL_HANDLE) {
    vkDestroyDevice(device_, nullptr);
    device::count_closed(device_);
  }
  if (surface_ != VK_NULL_HANDLE) vkDestroySurfaceKHR(instance_, surface_, nullptr);
  if (messenger_ != VK_NULL_HANDLE) {
    auto destroy_messenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy_messenger(instance_, messenger_, nullptr);
  }
  if (instance_ != VK_NULL_HANDLE) vkDestroyInstance(instance_, nullptr);
}

void Context::create_instance(const device::DeviceOptions& options) {
  if (options.validation && !layer_present(validation_layer)) {
    throw DeviceError(std::string(validation_layer) + " is not installed (Debian: vulkan-validationlayers)");
  }
  debug_utils_ = extension_present(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  std::vector<const char*> extensions;
  if (debug_utils_) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  if (options.surface) {
    for (const std::string& name : options.surface->instance_extensions) extensions.push_back(name.c_str());
  }

  const VkApplicationInfo application = application_info();
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &application;
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  info.enabledLayerCount = options.validation ? 1 : 0;
  info.ppEnabledLayerNames = &validation_layer;
  keep_drivers_loaded();
  check(vkCreateInstance(&info, nullptr, &instance_), "vkCreateInstance");
}

void Context::create_messenger() {
  if (!debug_utils_) throw DeviceError("validation needs VK_EXT_debug_utils, which the loader does not offer");
  VkDebugUtilsMessengerCreateInfoEXT info{};
  info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = on_message;
  info.pUserData = this;
  auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
  check(create(instance_, &info, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
}

VkBool32 Context::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                             const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  auto& self = *static_cast<Context*>(user);
  const std::lock_guard lock(self.messages_lock_);  // of pipelines, which threads of their own make
  self.messages_.emplace_back(data->pMessage);
  return VK_FALSE;
}

void Context::pick_device(const std::string& wanted) {
  std::string seen;
  int best = 4;
  for (VkPhysicalDevice candidate : physical_devices(instance_)) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(candidate, &properties);
    const std::string missing = what_is_missing(candidate, surface_);
    seen += std::string(seen.empty() ? "" : "; ") + properties.deviceName;
    if (!missing.empty()) seen += " (lacks " + missing + ")";
    const bool meant = lower(properties.deviceName).find(lower(wanted)) != std::string::npos;
    if (!missing.empty() || !meant || preference(properties.deviceType) >= best) continue;
    best = preference(properties.deviceType);
    physical_device_ = candidate;
  }
  if (physical_device_ == VK_NULL_HANDLE) {
    throw DeviceError("no usable Vulkan device" + (wanted.empty() ? "" : " named '" + wanted + "'") +
                      "; found: " + (seen.empty() ? "none (Debian: mesa-vulkan-drivers has a software device)" : seen));
  }
}

void Context::read_properties() {
  VkPhysicalDeviceMaintenance4Properties maintenance4{};
  maintenance4.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES;
  VkPhysicalDeviceMaintenance3Properties maintenance3{};
  maintenance3.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES;
  maintenance3.pNext = &maintenance4;
  const Identity identity(physical_device_, &maintenance3);
  limits_ = identity.device().limits;
  max_buffer_bytes_ = std::min(maintenance3.maxMemoryAllocationSize, maintenance4.maxBufferSize);
  info_ = {identity.device().deviceName, identity.driver_text(), identity.software()};
  max_image_side_ = limits_.maxImageDimension2D;
  max_workgroups_ = limits_.maxComputeWorkGroupCount[0];
  vkGetPhysicalDeviceMemoryProperties(physical_device_, &memory_properties_);
}

void Context::create_device() {
  queue_family_ = find_family(physical_device_, surface_).value();
  const float priority = 1.0f;
  VkDeviceQueueCreateInfo queue_info{};
  queue_info.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue_info.queueFamilyIndex = queue_family_;
  queue_info.queueCount = 1;
  queue_info.pQueuePriorities = &priority;
  Features features;
  for (const auto& [name, value] : features.required()) *value = VK_TRUE;
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.pNext = &features.base;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue_info;
  const char* const swapchain = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
  info.enabledExtensionCount = surface_ != VK_NULL_HANDLE ? 1 : 0;
  info.ppEnabledExtensionNames = &swapchain;
  check(vkCreateDevice(physical_device_, &info, nullptr, &device_), "vkCreateDevice");
  books_ = device_;
  device::count_opened(device_);
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
  if (debug_utils_) {
    set_object_name_ = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(
        vkGetDeviceProcAddr(device_, "vkSetDebugUtilsObjectNameEXT"));
  }
}

std::uint32_t Context::memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags required,
                                   VkMemoryPropertyFlags preferred) const {
  for (VkMemoryPropertyFlags flags : {required | preferred, required}) {
    for (std::uint32_t i = 0; i < memory_properties_.memoryTypeCount; ++i) {
      const bool allowed = (type_bits >> i & 1u) != 0;
      if (allowed && (memory_properties_.memoryTypes[i].propertyFlags & flags) == flags) return i;
    }
  }
  throw DeviceError(info_.name + " has no memory type with properties " + std::to_string(required));
}

void Context::set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const {
  if (set_object_name_ == nullptr) return;
  VkDebugUtilsObjectNameInfoEXT info{};
  info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT;
  info.objectType = type;
  info.objectHandle = handle;
  info.pObjectName = name.c_str();
  check(set_object_name_(device_, &info), "vkSetDebugUtilsObjectNameEXT");
}

}  // namespace quadgraph::vk
