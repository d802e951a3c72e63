// Memory that shaders read as one buffer of 32-bit texels (shaders/load.glsl), and the descriptor set that shows it.
//
// llvmpipe, Mesa's device on the CPU, follows a buffer reference one invocation after the other, but fetches the texels
// of eight at once: products with an operator's rows take a ninth of the time. So on devices of type CPU all buffers of
// Place::read lie here. Elsewhere the arena holds one texel that nothing reads, and they lie where others do. So does
// what finds no room here, and from then on all shaders follow references.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <map>
#include <optional>

#include "engine/vk/handle.h"

namespace quadgraph::vk {

class Context;

class Arena {
 public:
  // `bytes`, or as many as the device can show as one texel buffer; they cost address space until they are written.
  Arena(Context& context, std::uint64_t bytes);
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  bool used() const { return used_; }

  // Whether it is used and all that asked for room has got it.
  bool complete() const { return used_ && !overflowed_; }

  std::uint64_t size() const { return size_; }  // bytes
  VkDeviceMemory memory() const { return memory_.get(); }
  VkDeviceAddress address() const { return address_; }
  VkDescriptorSetLayout layout() const { return layout_.get(); }
  VkDescriptorSet set() const { return set_; }

  // Offset of a free range in `memory`, bytes; nothing, and no longer complete, if there is none.
  std::optional<std::uint64_t> take(std::uint64_t size, std::uint64_t alignment);

  // Gives a range back.
  void release(std::uint64_t offset, std::uint64_t size);

 private:
  void create_texels(Context& context);
  void create_view(Context& context);
  void create_set(Context& context);

  bool used_;
  bool overflowed_ = false;
  std::uint64_t size_;
  UniqueMemory memory_;
  UniqueBuffer texels_;
  VkDeviceAddress address_ = 0;
  UniqueBufferView view_;
  UniqueDescriptorSetLayout layout_;
  UniqueDescriptorPool pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  std::map<std::uint64_t, std::uint64_t> free_;  // size by offset, none touching the next
};

}  // namespace quadgraph::vk
