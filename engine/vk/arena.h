// Memory that shaders read as buffers of 32-bit texels (shaders/shared/load.glsl), and the descriptor set that shows
// it.
//
// llvmpipe, Mesa's device on the CPU, follows a buffer reference one invocation after the other, but fetches the texels
// of eight at once: products with an operator's rows take a ninth of the time. So on devices of type CPU all buffers
// that shaders load lie in arenas. There is one for each place of such buffers (memory.h), because a device shows only
// so much as one buffer of texels: 512 MB on lavapipe. Elsewhere an arena holds one texel that nothing reads, and its
// buffers lie where others do. So does what finds no room in its arena, and from then on shaders follow references to
// all that belongs there.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "engine/vk/handle.h"

namespace quadgraph::vk {

class Context;

class Arena {
 public:
  // `bytes`, or as many as the device can show as one texel buffer; they cost address space until they are written.
  Arena(Context& context, std::uint64_t bytes, const std::string& name);
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  bool used() const { return used_; }

  // Whether it is used and all that asked for room has got it.
  bool complete() const { return used_ && !overflowed_; }

  std::uint64_t size() const { return size_; }  // bytes
  VkDeviceMemory memory() const { return memory_.get(); }
  VkDeviceAddress address() const { return address_; }
  VkBufferView view() const { return view_.get(); }

  // Offset of a free range in `memory`, bytes; nothing, and no longer complete, if there is none.
  std::optional<std::uint64_t> take(std::uint64_t size, std::uint64_t alignment);

  // Gives a range back.
  void release(std::uint64_t offset, std::uint64_t size);

 private:
  void create_texels(Context& context, const std::string& name);
  void create_view(Context& context, const std::string& name);

  bool used_;
  bool overflowed_ = false;
  std::uint64_t size_;
  UniqueMemory memory_;
  UniqueBuffer texels_;
  VkDeviceAddress address_ = 0;
  UniqueBufferView view_;
  std::map<std::uint64_t, std::uint64_t> free_;  // size by offset, none touching the next
};

// Numbers of the arenas: binding in the set, and bit of `complete`.
constexpr std::uint32_t arena_count = 4;

class Arenas {
 public:
  // `bytes` each.
  Arenas(Context& context, std::uint64_t bytes);

  Arena& operator[](std::uint32_t number) { return all_[number]; }
  const Arena& operator[](std::uint32_t number) const { return all_[number]; }

  // Those that are complete, a bit each.
  std::uint32_t complete() const;

  VkDescriptorSetLayout layout() const { return layout_.get(); }
  VkDescriptorSet set() const { return set_; }

 private:
  void create_set(Context& context);

  std::array<Arena, arena_count> all_;
  UniqueDescriptorSetLayout layout_;
  UniqueDescriptorPool pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace quadgraph::vk
