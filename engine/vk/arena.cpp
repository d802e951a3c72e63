#include "engine/vk/arena.h"

#include <algorithm>
#include <iterator>

#include "engine/base/error.h"
#include "engine/vk/context.h"

namespace quadgraph::vk {
namespace {

constexpr std::uint64_t texel_bytes = sizeof(std::uint32_t);

std::uint64_t largest_view(const Context& context) {
  return std::min(context.limits().maxTexelBufferElements * texel_bytes, context.max_buffer_bytes());
}

}  // namespace

Arena::Arena(Context& context, std::uint64_t bytes, const std::string& name)
    : used_(bytes > 0), size_(used_ ? std::min(bytes, largest_view(context)) : texel_bytes) {
  if (used_) free_[0] = size_;
  create_texels(context, name);
  create_view(context, name);
}

void Arena::create_texels(Context& context, const std::string& name) {
  VkBufferCreateInfo buffer_info{};
  buffer_info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  buffer_info.size = size_;
  buffer_info.usage = VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  check(vkCreateBuffer(context.device(), &buffer_info, nullptr, &buffer), "vkCreateBuffer '" + name + "'");
  texels_ = UniqueBuffer(context.device(), buffer);
  VkMemoryRequirements requirements;
  vkGetBufferMemoryRequirements(context.device(), buffer, &requirements);

  VkMemoryAllocateFlagsInfo flags{};
  flags.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO;
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  VkMemoryAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  info.pNext = &flags;
  info.allocationSize = requirements.size;
  info.memoryTypeIndex = context.memory_type(requirements.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  VkDeviceMemory memory = VK_NULL_HANDLE;
  check(vkAllocateMemory(context.device(), &info, nullptr, &memory),
        "vkAllocateMemory '" + name + "' of " + std::to_string(requirements.size) + " bytes");
  memory_ = UniqueMemory(context.device(), memory);
  check(vkBindBufferMemory(context.device(), buffer, memory, 0), "vkBindBufferMemory '" + name + "'");
  VkBufferDeviceAddressInfo address{};
  address.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO;
  address.buffer = buffer;
  address_ = vkGetBufferDeviceAddress(context.device(), &address);
}

void Arena::create_view(Context& context, const std::string& name) {
  VkBufferViewCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO;
  info.buffer = texels_.get();
  info.format = VK_FORMAT_R32_UINT;
  info.range = size_;
  VkBufferView view = VK_NULL_HANDLE;
  check(vkCreateBufferView(context.device(), &info, nullptr, &view), "vkCreateBufferView '" + name + "'");
  view_ = UniqueBufferView(context.device(), view);
}

std::optional<std::uint64_t> Arena::take(std::uint64_t size, std::uint64_t alignment) {
  for (const auto& [begin, length] : free_) {
    const std::uint64_t offset = (begin + alignment - 1) / alignment * alignment, before = offset - begin;
    if (length < before + size) continue;
    const std::uint64_t from = begin, after = length - before - size;
    free_.erase(from);
    if (before > 0) free_[from] = before;
    if (after > 0) free_[offset + size] = after;
    return offset;
  }
  overflowed_ = true;
  return std::nullopt;
}

void Arena::release(std::uint64_t offset, std::uint64_t size) {
  const auto next = free_.lower_bound(offset);
  if (next != free_.end() && next->first == offset + size) {
    size += next->second;
    free_.erase(next);
  }
  const auto place = free_.emplace(offset, size).first;
  if (place == free_.begin()) return;
  const auto previous = std::prev(place);
  if (previous->first + previous->second == offset) {
    previous->second += size;
    free_.erase(place);
  }
}

Arenas::Arenas(Context& context, std::uint64_t bytes)
    : all_{Arena(context, bytes, "arena/read"), Arena(context, bytes, "arena/rows"),
           Arena(context, bytes, "arena/fields"), Arena(context, bytes, "arena/assembly")} {
  create_set(context);
}

std::uint32_t Arenas::complete() const {
  std::uint32_t bits = 0;
  for (std::uint32_t i = 0; i < arena_count; ++i) bits |= all_[i].complete() ? 1u << i : 0u;
  return bits;
}

void Arenas::create_set(Context& context) {
  std::array<VkDescriptorSetLayoutBinding, arena_count> bindings;
  for (std::uint32_t i = 0; i < arena_count; ++i) {
    bindings[i] = {i, VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, 1, VK_SHADER_STAGE_ALL, nullptr};
  }
  VkDescriptorSetLayoutCreateInfo layout_info{};
  layout_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  layout_info.bindingCount = arena_count;
  layout_info.pBindings = bindings.data();
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  check(vkCreateDescriptorSetLayout(context.device(), &layout_info, nullptr, &layout), "vkCreateDescriptorSetLayout");
  layout_ = UniqueDescriptorSetLayout(context.device(), layout);

  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, arena_count};
  VkDescriptorPoolCreateInfo pool_info{};
  pool_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  pool_info.maxSets = 1;
  pool_info.poolSizeCount = 1;
  pool_info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  check(vkCreateDescriptorPool(context.device(), &pool_info, nullptr, &pool), "vkCreateDescriptorPool");
  pool_ = UniqueDescriptorPool(context.device(), pool);

  VkDescriptorSetAllocateInfo set_info{};
  set_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  set_info.descriptorPool = pool;
  set_info.descriptorSetCount = 1;
  set_info.pSetLayouts = &layout;
  check(vkAllocateDescriptorSets(context.device(), &set_info, &set_), "vkAllocateDescriptorSets");
  for (std::uint32_t i = 0; i < arena_count; ++i) {
    const VkBufferView view = all_[i].view();
    VkWriteDescriptorSet write{};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = set_;
    write.dstBinding = i;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
    write.pTexelBufferView = &view;
    vkUpdateDescriptorSets(context.device(), 1, &write, 0, nullptr);
  }
}

}  // namespace quadgraph::vk
