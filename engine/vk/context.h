// One Vulkan device with one queue that can compute and draw and, for a window, present.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/device/device.h"
#include "engine/vk/handle.h"

namespace quadgraph::vk {

// What a device needs of a window to present to it (swapchain.h). The window must outlive the device.
struct SurfaceSource {
  std::vector<std::string> instance_extensions;
  std::function<VkSurfaceKHR(VkInstance)> create;  // throws DeviceError; the device destroys what it returns
};

struct RecordingParts;

class Context : public device::Device {
 public:
  explicit Context(const device::DeviceOptions& options = {});
  ~Context() override;
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  VkInstance instance() const { return instance_; }
  VkSurfaceKHR surface() const { return surface_; }  // null without a window
  VkPhysicalDevice physical_device() const { return physical_device_; }
  VkDevice device() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::uint32_t queue_family() const { return queue_family_; }
  const VkPhysicalDeviceLimits& limits() const { return limits_; }

  // Index of a memory type allowed by `type_bits` with all of `required`, preferring `preferred`. Throws DeviceError.
  std::uint32_t memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags required,
                            VkMemoryPropertyFlags preferred) const;

  std::unique_ptr<device::Memory> allocate(std::uint64_t bytes, device::Place place, const std::string& name) override;
  std::unique_ptr<device::ImageMemory> allocate(const device::ImageOptions& options, const std::string& name) override;
  std::unique_ptr<device::Pipeline> compile(const device::Shader& shader, const device::ComputeOptions& options,
                                            const std::string& name) override;
  std::unique_ptr<device::Pipeline> compile(const device::GraphicsOptions& options, const std::string& name) override;
  std::unique_ptr<device::Recording> record(std::uint32_t max_passes) override;

  // Submits updates that wait: what they write to may be going to be destroyed.
  void finish_updates() noexcept;

  // Parts for a recording with room for so many timestamps, and back when it is done with them.
  std::unique_ptr<RecordingParts> take_parts(std::uint32_t queries);
  void give_back(std::unique_ptr<RecordingParts> parts) noexcept;

  // Names an object for validation messages and debuggers; does nothing without the debug extension.
  void set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const;

 private:
  void create_instance(const device::DeviceOptions& options);
  void create_messenger();
  void pick_device(const std::string& wanted);
  void read_properties();
  void create_device();
  void destroy() noexcept;
  static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                   VkDebugUtilsMessageTypeFlagsEXT types,
                                                   const VkDebugUtilsMessengerCallbackDataEXT* data, void* user);

  std::vector<std::unique_ptr<RecordingParts>> idle_;
  std::mutex messages_lock_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queue_family_ = 0;
  VkPhysicalDeviceLimits limits_{};
  VkPhysicalDeviceMemoryProperties memory_properties_{};
  bool debug_utils_ = false;
  PFN_vkSetDebugUtilsObjectNameEXT set_object_name_ = nullptr;
};

}  // namespace quadgraph::vk
