// Buffers and images of a device.
//
// The name of a buffer or image is "purpose/what it is", like "operator/level 0 weight"; Device adds up memory by
// purpose.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/device/device.h"

namespace quadgraph::device {

// Owns what was allocated, and keeps the device's books of it.
template <typename Owned>
class Counted {
 public:
  Counted() = default;
  Counted(Device& device, std::unique_ptr<Owned> owned, const std::string& name)
      : device_(&device), owned_(std::move(owned)), purpose_(name.substr(0, name.find('/'))) {
    device_->count(purpose_, owned_->allocated);
  }
  Counted(Counted&&) noexcept = default;
  Counted& operator=(Counted&& other) noexcept {
    release();
    device_ = other.device_;
    owned_ = std::move(other.owned_);
    purpose_ = std::move(other.purpose_);
    return *this;
  }
  ~Counted() { release(); }

  Owned* get() const { return owned_.get(); }

 private:
  void release() noexcept {
    if (owned_) device_->uncount(purpose_, owned_->allocated);
    owned_.reset();
  }

  Device* device_ = nullptr;
  std::unique_ptr<Owned> owned_;
  std::string purpose_;
};

// A storage buffer reached by its address. `size` is in bytes and may be 0, which allocates the minimum. Throws
// DeviceError naming the buffer if the device allows no buffer of that size or has no memory left.
class Buffer {
 public:
  Buffer() = default;
  Buffer(Device& device, std::uint64_t size, Place place, const std::string& name);

  bool exists() const { return memory_.get() != nullptr; }
  const Memory& memory() const { return *memory_.get(); }
  std::uint64_t address() const { return exists() ? memory().address : 0; }
  std::uint64_t size() const { return size_; }
  void* mapped() const { return exists() ? memory().mapped : nullptr; }  // null where the host sees none

  template <typename T>
  std::span<T> mapped_as() const {
    return {static_cast<T*>(mapped()), static_cast<std::size_t>(size_ / sizeof(T))};
  }

 private:
  std::uint64_t size_ = 0;
  Counted<Memory> memory_;
};

// A device buffer filled with `data` through a staging copy; waits for it.
Buffer upload_bytes(Device& device, std::span<const std::byte> data, const std::string& name);

template <typename T>
Buffer upload(Device& device, std::span<const T> data, const std::string& name) {
  static_assert(std::is_trivially_copyable_v<T>);
  return upload_bytes(device, std::as_bytes(data), name);
}

// Replaces the first bytes of `target`; waits for it.
void write_bytes(Device& device, const Buffer& target, std::span<const std::byte> data);

// Makes `target` hold `data`: in place where it is of that size, else in a new buffer; waits for it.
template <typename T>
void rewrite(Device& device, std::span<const T> data, const std::string& name, Buffer& target) {
  if (!target.exists() || target.size() != data.size_bytes()) {
    target = upload(device, data, name);
  } else {
    write_bytes(device, target, std::as_bytes(data));
  }
}

// Copies a buffer back; waits for it.
void read_bytes(Device& device, const Buffer& source, std::span<std::byte> target);

template <typename T>
std::vector<T> download(Device& device, const Buffer& source) {
  std::vector<T> values(source.size() / sizeof(T));
  read_bytes(device, source, std::as_writable_bytes(std::span<T>(values)));
  return values;
}

// A 2D image with one mip level. Contents undefined at first. Throws DeviceError as Buffer does, InputError where it is
// wider or higher than the device allows.
class Image {
 public:
  Image() = default;
  Image(Device& device, const ImageOptions& options, const std::string& name);

  ImageMemory& memory() const { return *memory_.get(); }
  std::uint64_t address() const { return memory().address; }  // 0: it has to be copied into a buffer to be read
  const ImageOptions& options() const { return options_; }

 private:
  ImageOptions options_;
  Counted<ImageMemory> memory_;
};

}  // namespace quadgraph::device
