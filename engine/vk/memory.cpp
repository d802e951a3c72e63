#include "engine/vk/memory.h"

#include <algorithm>
#include <cstring>

#include "engine/base/error.h"
#include "engine/vk/arena.h"
#include "engine/vk/commands.h"

namespace quadgraph::vk {

namespace {

// Bytes that a command buffer takes along (vkCmdUpdateBuffer).
constexpr std::size_t largest_update = 65536;

}  // namespace

Allocation::Allocation(Context& context, const VkMemoryRequirements& requirements, Place place, bool device_address,
                       const std::string& name)
    : context_(&context), size_(requirements.size), purpose_(name.substr(0, name.find('/'))), place_(place) {
  const bool in_arena = arena_of(place) < arena_count && take_range(requirements);
  if (!in_arena) allocate(requirements, place, device_address);
  context.allocated_bytes_ += size_;
  context.allocated_by_purpose_[purpose_] += size_;
  ++context.allocation_count_;
  context.peak_allocated_bytes_ = std::max(context.peak_allocated_bytes_, context.allocated_bytes_);
}

bool Allocation::take_range(const VkMemoryRequirements& requirements) {
  Arena& arena = context_->arenas()[arena_of(place_)];
  if (!arena.used()) return false;
  const auto offset = arena.take(size_, requirements.alignment);
  if (!offset) return false;
  offset_ = *offset;
  memory_ = arena.memory();
  return true;
}

void Allocation::allocate(const VkMemoryRequirements& requirements, Place place, bool device_address) {
  VkMemoryAllocateFlagsInfo flags{};
  flags.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO;
  flags.flags = device_address ? VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT : 0;
  VkMemoryAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  info.pNext = &flags;
  info.allocationSize = requirements.size;
  info.memoryTypeIndex =
      place == Place::host
          ? context_->memory_type(requirements.memoryTypeBits,
                                  VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                                  VK_MEMORY_PROPERTY_HOST_CACHED_BIT)
          : context_->memory_type(requirements.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  check(vkAllocateMemory(context_->device(), &info, nullptr, &memory_),
        "vkAllocateMemory of " + std::to_string(requirements.size) + " bytes");
  own_ = UniqueMemory(context_->device(), memory_);
}

Allocation::Allocation(Allocation&& other) noexcept {
  *this = std::move(other);
}

Allocation& Allocation::operator=(Allocation&& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(size_, other.size_);
  std::swap(offset_, other.offset_);
  std::swap(purpose_, other.purpose_);
  std::swap(place_, other.place_);
  std::swap(memory_, other.memory_);
  std::swap(own_, other.own_);
  return *this;
}

Allocation::~Allocation() {
  if (context_ == nullptr || memory_ == VK_NULL_HANDLE) return;
  if (own_.get() == VK_NULL_HANDLE) context_->arenas()[arena_of(place_)].release(offset_, size_);
  context_->allocated_bytes_ -= size_;
  const auto of_purpose = context_->allocated_by_purpose_.find(purpose_);
  of_purpose->second -= size_;
  if (of_purpose->second == 0) context_->allocated_by_purpose_.erase(of_purpose);
}

Buffer::Buffer(Context& context, std::uint64_t size, Place place, const std::string& name) : size_(size) {
  if (size > context.max_buffer_bytes()) {
    throw VulkanError("buffer '" + name + "' of " + std::to_string(size) + " bytes: " + context.info().name +
                      " allows at most " + std::to_string(context.max_buffer_bytes()));
  }
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = std::max<std::uint64_t>(size, 4);
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
               VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  check(vkCreateBuffer(context.device(), &info, nullptr, &buffer), "vkCreateBuffer '" + name + "'");
  buffer_ = UniqueBuffer(context.device(), buffer);
  context.set_name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(buffer), name);

  VkMemoryRequirements requirements;
  vkGetBufferMemoryRequirements(context.device(), buffer, &requirements);
  try {
    allocation_ = Allocation(context, requirements, place, true, name);
  } catch (const VulkanError& error) {
    throw VulkanError("buffer '" + name + "': " + error.what() + "; " + std::to_string(context.allocated_bytes()) +
                      " bytes are in use");
  }
  check(vkBindBufferMemory(context.device(), buffer, allocation_.memory(), allocation_.offset()),
        "vkBindBufferMemory '" + name + "'");
  if (place == Place::host) {
    check(vkMapMemory(context.device(), allocation_.memory(), 0, VK_WHOLE_SIZE, 0, &mapped_),
          "vkMapMemory '" + name + "'");
  }
  VkBufferDeviceAddressInfo address_info{};
  address_info.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO;
  address_info.buffer = buffer;
  address_ = vkGetBufferDeviceAddress(context.device(), &address_info);
}

Buffer upload_bytes(Context& context, std::span<const std::byte> data, const std::string& name, Place place) {
  Buffer target(context, data.size(), place, name);
  write_bytes(context, target, data);
  return target;
}

void write_bytes(Context& context, const Buffer& target, std::span<const std::byte> data) {
  if (data.size() > target.size()) {
    throw InputError("buffer holds " + std::to_string(target.size()) + " bytes, got " + std::to_string(data.size()));
  }
  if (data.empty()) return;
  if (data.size() <= largest_update && data.size() % 4 == 0) {
    Commands commands(context);
    commands.update(target, data);
    return static_cast<void>(commands.submit_and_wait());
  }
  const Buffer staging(context, data.size(), Place::host, "staging/upload");
  std::memcpy(staging.mapped(), data.data(), data.size());
  Commands commands(context);
  commands.copy(staging, target, data.size());
  commands.submit_and_wait();
}

void read_bytes(Context& context, const Buffer& source, std::span<std::byte> target) {
  if (target.size() > source.size()) {
    throw InputError("buffer holds " + std::to_string(source.size()) + " bytes, asked for " +
                     std::to_string(target.size()));
  }
  if (target.empty()) return;
  const Buffer staging(context, target.size(), Place::host, "staging/read-back");
  Commands commands(context);
  commands.barrier();
  commands.copy(source, staging, target.size());
  commands.submit_and_wait();
  std::memcpy(target.data(), staging.mapped(), target.size());
}

VkImageAspectFlags Image::aspect() const {
  return options_.format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

Image::Image(Context& context, const ImageOptions& options, const std::string& name) : options_(options) {
  const std::uint32_t limit = context.limits().maxImageDimension2D;
  if (options.width > limit || options.height > limit) {
    throw InputError("image '" + name + "' of " + std::to_string(options.width) + " x " +
                     std::to_string(options.height) + " pixels: " + context.info().name + " allows at most " +
                     std::to_string(limit));
  }
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = options.format;
  info.extent = {options.width, options.height, 1};
  info.mipLevels = 1;
  info.arrayLayers = options.layers;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = options.usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  VkImage image = VK_NULL_HANDLE;
  check(vkCreateImage(context.device(), &info, nullptr, &image), "vkCreateImage '" + name + "'");
  image_ = UniqueImage(context.device(), image);
  context.set_name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(image), name);

  VkMemoryRequirements requirements;
  vkGetImageMemoryRequirements(context.device(), image, &requirements);
  allocation_ = Allocation(context, requirements, Place::device, false, name);
  check(vkBindImageMemory(context.device(), image, allocation_.memory(), 0), "vkBindImageMemory '" + name + "'");

  for (std::uint32_t layer = 0; layer < options.layers; ++layer) {
    VkImageViewCreateInfo view_info{};
    view_info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    view_info.image = image;
    view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view_info.format = options.format;
    view_info.subresourceRange = {aspect(), 0, 1, layer, 1};
    VkImageView view = VK_NULL_HANDLE;
    check(vkCreateImageView(context.device(), &view_info, nullptr, &view), "vkCreateImageView '" + name + "'");
    views_.emplace_back(context.device(), view);
  }
}

}  // namespace quadgraph::vk
