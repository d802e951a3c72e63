// Buffers and images of Vulkan, each with its memory.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/device/device.h"
#include "engine/vk/context.h"
#include "engine/vk/handle.h"

namespace quadgraph::vk {

struct BufferMemory : device::Memory {
  BufferMemory(Context& context, std::uint64_t size, device::Place place, const std::string& name);
  ~BufferMemory() override { context.finish_updates(); }

  Context& context;
  UniqueMemory memory;
  UniqueBuffer buffer;
};

// A 2D image with one mip level and one view per layer.
struct ImageMemory : device::ImageMemory {
  ImageMemory(Context& context, const device::ImageOptions& wanted, const std::string& name);

  VkImageAspectFlags aspect() const;

  device::ImageOptions options;
  UniqueMemory memory;
  UniqueImage image;
  std::vector<UniqueImageView> views;
};

VkFormat vulkan_format(device::Format format);

inline VkBuffer handle_of(const device::Memory& memory) {
  return static_cast<const BufferMemory&>(memory).buffer.get();
}

}  // namespace quadgraph::vk
