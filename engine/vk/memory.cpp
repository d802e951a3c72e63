#include "engine/vk/memory.h"

#include <algorithm>

namespace quadgraph::vk {
namespace {

UniqueMemory allocate(Context& context, const VkMemoryRequirements& requirements, device::Place place,
                      bool device_address) {
  VkMemoryAllocateFlagsInfo flags{};
  flags.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO;
  flags.flags = device_address ? VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT : 0;
  VkMemoryAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  info.pNext = &flags;
  info.allocationSize = requirements.size;
  info.memoryTypeIndex =
      place == device::Place::host
          ? context.memory_type(requirements.memoryTypeBits,
                                VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                                VK_MEMORY_PROPERTY_HOST_CACHED_BIT)
          : context.memory_type(requirements.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  VkDeviceMemory memory = VK_NULL_HANDLE;
  check(vkAllocateMemory(context.device(), &info, nullptr, &memory),
        "vkAllocateMemory of " + std::to_string(requirements.size) + " bytes");
  return {context.device(), memory};
}

UniqueImage create_image(Context& context, const device::ImageOptions& options, const std::string& name) {
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = vulkan_format(options.format);
  info.extent = {options.width, options.height, 1};
  info.mipLevels = 1;
  info.arrayLayers = options.layers;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
               (options.format == device::Format::depth32_float ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                                                : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
  VkImage image = VK_NULL_HANDLE;
  check(vkCreateImage(context.device(), &info, nullptr, &image), "vkCreateImage '" + name + "'");
  context.set_name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(image), name);
  return {context.device(), image};
}

}  // namespace

VkFormat vulkan_format(device::Format format) {
  switch (format) {
    case device::Format::depth32_float:
      return VK_FORMAT_D32_SFLOAT;
    case device::Format::r32_uint:
      return VK_FORMAT_R32_UINT;
    case device::Format::rgba32_float:
      break;
  }
  return VK_FORMAT_R32G32B32A32_SFLOAT;
}

BufferMemory::BufferMemory(Context& its_context, std::uint64_t size, device::Place place, const std::string& name)
    : context(its_context) {
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = std::max<std::uint64_t>(size, 4);
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
               VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
  VkBuffer handle = VK_NULL_HANDLE;
  check(vkCreateBuffer(context.device(), &info, nullptr, &handle), "vkCreateBuffer '" + name + "'");
  buffer = UniqueBuffer(context.device(), handle);
  context.set_name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(handle), name);

  VkMemoryRequirements requirements;
  vkGetBufferMemoryRequirements(context.device(), handle, &requirements);
  memory = vk::allocate(context, requirements, place, true);
  allocated = requirements.size;
  check(vkBindBufferMemory(context.device(), handle, memory.get(), 0), "vkBindBufferMemory '" + name + "'");
  if (place == device::Place::host) {
    check(vkMapMemory(context.device(), memory.get(), 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory '" + name + "'");
  }
  VkBufferDeviceAddressInfo address_info{};
  address_info.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO;
  address_info.buffer = handle;
  address = vkGetBufferDeviceAddress(context.device(), &address_info);
}

VkImageAspectFlags ImageMemory::aspect() const {
  return options.format == device::Format::depth32_float ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

ImageMemory::ImageMemory(Context& context, const device::ImageOptions& wanted, const std::string& name)
    : options(wanted), image(create_image(context, wanted, name)) {
  VkMemoryRequirements requirements;
  vkGetImageMemoryRequirements(context.device(), image.get(), &requirements);
  memory = vk::allocate(context, requirements, device::Place::device, false);
  allocated = requirements.size;
  check(vkBindImageMemory(context.device(), image.get(), memory.get(), 0), "vkBindImageMemory '" + name + "'");

  for (std::uint32_t layer = 0; layer < options.layers; ++layer) {
    VkImageViewCreateInfo view_info{};
    view_info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    view_info.image = image.get();
    view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view_info.format = vulkan_format(options.format);
    view_info.subresourceRange = {aspect(), 0, 1, layer, 1};
    VkImageView view = VK_NULL_HANDLE;
    check(vkCreateImageView(context.device(), &view_info, nullptr, &view), "vkCreateImageView '" + name + "'");
    views.emplace_back(context.device(), view);
  }
}

std::unique_ptr<device::Memory> Context::allocate(std::uint64_t bytes, device::Place place, const std::string& name) {
  return std::make_unique<BufferMemory>(*this, bytes, place, name);
}

std::unique_ptr<device::ImageMemory> Context::allocate(const device::ImageOptions& options, const std::string& name) {
  return std::make_unique<ImageMemory>(*this, options, name);
}

}  // namespace quadgraph::vk
