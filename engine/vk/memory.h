// Device memory, buffers and images: each owns its handle and its memory together.
//
// The name of a buffer or image is "purpose/what it is", like "operator/level 0 weight"; Context adds up memory by
// purpose.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/vk/context.h"
#include "engine/vk/handle.h"

namespace quadgraph::vk {

enum class Place {
  // Fastest for the GPU, and in the arena of that name where there is one with room: arrays that shaders load, by the
  // type they have there (shaders/shared/load.glsl).
  read,      // Uints, Floats and all that is not one of the following
  rows,      // Entries, RowUints, RowFloats: operators and the transfers between their levels
  fields,    // Fields, Opticals: what carriers have
  assembly,  // Assembly...: what operators are filled from
  device,    // fastest for the GPU
  host,      // mapped, coherent, cached if possible: uploads and read-backs
};

constexpr std::uint32_t arena_of(Place place) {
  return static_cast<std::uint32_t>(place);
}

// One allocation, or a range of the arena; counted in Context::allocated_bytes.
class Allocation {
 public:
  Allocation() = default;
  Allocation(Context& context, const VkMemoryRequirements& requirements, Place place, bool device_address,
             const std::string& name);
  Allocation(Allocation&& other) noexcept;
  Allocation& operator=(Allocation&& other) noexcept;
  ~Allocation();

  VkDeviceMemory memory() const { return memory_; }
  std::uint64_t offset() const { return offset_; }  // bytes, in memory

 private:
  bool take_range(const VkMemoryRequirements& requirements);
  void allocate(const VkMemoryRequirements& requirements, Place place, bool device_address);

  Context* context_ = nullptr;
  std::uint64_t size_ = 0;
  std::uint64_t offset_ = 0;
  std::string purpose_;
  Place place_ = Place::device;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  UniqueMemory own_;  // none in a range of the arena
};

// A storage buffer reached by its device address. `size` is in bytes and may be 0, which allocates the minimum. Throws
// VulkanError naming the buffer if the device allows no buffer of that size or has no memory left.
class Buffer {
 public:
  Buffer() = default;
  Buffer(Context& context, std::uint64_t size, Place place, const std::string& name);

  VkBuffer handle() const { return buffer_.get(); }
  VkDeviceAddress address() const { return address_; }
  std::uint64_t size() const { return size_; }
  void* mapped() const { return mapped_; }  // null for Place::device

  template <typename T>
  std::span<T> mapped_as() const {
    return {static_cast<T*>(mapped_), static_cast<std::size_t>(size_ / sizeof(T))};
  }

 private:
  Allocation allocation_;
  UniqueBuffer buffer_;
  VkDeviceAddress address_ = 0;
  std::uint64_t size_ = 0;
  void* mapped_ = nullptr;
};

// A device buffer filled with `data` through a staging copy; waits for it.
Buffer upload_bytes(Context& context, std::span<const std::byte> data, const std::string& name, Place place);

template <typename T>
Buffer upload(Context& context, std::span<const T> data, const std::string& name, Place place = Place::read) {
  static_assert(std::is_trivially_copyable_v<T>);
  return upload_bytes(context, std::as_bytes(data), name, place);
}

// Replaces the first bytes of `target`; waits for it.
void write_bytes(Context& context, const Buffer& target, std::span<const std::byte> data);

// Makes `target` hold `data`: in place where it is of that size, else in a new buffer; waits for it.
template <typename T>
void rewrite(Context& context, std::span<const T> data, const std::string& name, Buffer& target) {
  if (target.handle() == VK_NULL_HANDLE || target.size() != data.size_bytes()) {
    target = upload(context, data, name);
  } else {
    write_bytes(context, target, std::as_bytes(data));
  }
}

// Copies a buffer back; waits for it.
void read_bytes(Context& context, const Buffer& source, std::span<std::byte> target);

template <typename T>
std::vector<T> download(Context& context, const Buffer& source) {
  std::vector<T> values(source.size() / sizeof(T));
  read_bytes(context, source, std::as_writable_bytes(std::span<T>(values)));
  return values;
}

struct ImageOptions {
  VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;
  std::uint32_t width = 1;   // pixels
  std::uint32_t height = 1;  // pixels
  std::uint32_t layers = 1;
  VkImageUsageFlags usage = 0;
};

// A 2D image with one mip level and one view per layer. Contents undefined at first.
class Image {
 public:
  Image() = default;
  Image(Context& context, const ImageOptions& options, const std::string& name);

  VkImage handle() const { return image_.get(); }
  VkImageView layer_view(std::uint32_t layer) const { return views_[layer].get(); }
  const ImageOptions& options() const { return options_; }
  VkImageAspectFlags aspect() const;

 private:
  ImageOptions options_;
  Allocation allocation_;
  UniqueImage image_;
  std::vector<UniqueImageView> views_;
};

}  // namespace quadgraph::vk
