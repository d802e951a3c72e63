// One Vulkan device with one queue that can compute and draw and, for a window, present. Everything else in vk/ borrows
// a Context and must die before it.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/vk/handle.h"

namespace quadgraph::vk {

class Arenas;

// What a context needs of a window to present to it (swapchain.h). The window must outlive the context.
struct SurfaceSource {
  std::vector<std::string> instance_extensions;
  std::function<VkSurfaceKHR(VkInstance)> create;  // throws VulkanError; the context destroys what it returns
};

struct ContextOptions {
  // Load VK_LAYER_KHRONOS_validation and keep its messages; VulkanError if the layer is not installed.
  bool validation = false;
  // Part of the device's name, case-insensitive; empty: a discrete GPU, else an integrated one, else any.
  std::string device;
  // Bytes of each arena of arrays that shaders read as texels (arena.h); unset: on a device of type CPU as many as it
  // can show, else 0.
  std::optional<std::uint64_t> texel_bytes = std::nullopt;
  // Of the window to present to; unset: none, and nothing that windows need is asked of the device.
  std::optional<SurfaceSource> surface = std::nullopt;
};

struct DeviceInfo {
  std::string name;
  std::string driver;  // name and version, as the driver reports it
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
};

class Context {
 public:
  explicit Context(const ContextOptions& options = {});
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  VkInstance instance() const { return instance_; }
  VkSurfaceKHR surface() const { return surface_; }  // null without a window
  VkPhysicalDevice physical_device() const { return physical_device_; }
  VkDevice device() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::uint32_t queue_family() const { return queue_family_; }
  const VkPhysicalDeviceLimits& limits() const { return limits_; }
  std::uint64_t max_buffer_bytes() const { return max_buffer_bytes_; }
  const DeviceInfo& info() const { return info_; }
  Arenas& arenas() { return *arenas_; }

  // Index of a memory type allowed by `type_bits` with all of `required`, preferring `preferred`. Throws VulkanError.
  std::uint32_t memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags required,
                            VkMemoryPropertyFlags preferred) const;

  // Bytes of memory allocated now, kept up to date by Allocation.
  std::uint64_t allocated_bytes() const { return allocated_bytes_; }

  // The same by purpose (memory.h), without those that have none.
  const std::map<std::string, std::uint64_t>& allocated_by_purpose() const { return allocated_by_purpose_; }

  // Allocations ever made.
  std::uint64_t allocation_count() const { return allocation_count_; }

  // The most there ever were at a time.
  std::uint64_t peak_allocated_bytes() const { return peak_allocated_bytes_; }

  // Names an object for validation messages and debuggers; does nothing without the debug extension.
  void set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const;

  // Warnings and errors of the validation layer so far; empty without `validation`.
  const std::vector<std::string>& validation_messages() const { return validation_messages_; }

 private:
  friend class Allocation;

  void create_instance(const ContextOptions& options);
  void create_messenger();
  void pick_device(const std::string& wanted);
  void read_properties();
  std::string what_is_missing(VkPhysicalDevice device) const;
  void create_device();
  void destroy() noexcept;
  static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                   VkDebugUtilsMessageTypeFlagsEXT types,
                                                   const VkDebugUtilsMessengerCallbackDataEXT* data, void* user);

  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queue_family_ = 0;
  VkPhysicalDeviceLimits limits_{};
  std::uint64_t max_buffer_bytes_ = 0;
  VkPhysicalDeviceMemoryProperties memory_properties_{};
  DeviceInfo info_;
  std::unique_ptr<Arenas> arenas_;
  bool debug_utils_ = false;
  PFN_vkSetDebugUtilsObjectNameEXT set_object_name_ = nullptr;
  std::uint64_t allocated_bytes_ = 0;
  std::uint64_t peak_allocated_bytes_ = 0;
  std::uint64_t allocation_count_ = 0;
  std::map<std::string, std::uint64_t> allocated_by_purpose_;
  std::vector<std::string> validation_messages_;
};

}  // namespace quadgraph::vk
