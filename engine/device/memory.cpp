#include "engine/device/memory.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "engine/base/error.h"
#include "engine/device/commands.h"

namespace quadgraph::device {
namespace {

// Bytes that Device::update takes.
constexpr std::size_t largest_update = 65536;
constexpr std::size_t least_staging = 65536, most_staging = std::size_t{16} << 20;  // bytes

std::unique_ptr<Memory> allocated(Device& device, std::uint64_t size, Place place, const std::string& name) {
  if (size > device.max_buffer_bytes()) {
    throw DeviceError("buffer '" + name + "' of " + std::to_string(size) + " bytes: " + device.info().name +
                      " allows at most " + std::to_string(device.max_buffer_bytes()));
  }
  try {
    return device.allocate(size, place, name);
  } catch (const DeviceError& error) {
    throw DeviceError("buffer '" + name + "': " + error.what() + "; " + std::to_string(device.allocated_bytes()) +
                      " bytes are in use");
  }
}

std::unique_ptr<ImageMemory> allocated(Device& device, const ImageOptions& options, const std::string& name) {
  const std::uint32_t limit = device.max_image_side();
  if (options.width > limit || options.height > limit) {
    throw InputError("image '" + name + "' of " + std::to_string(options.width) + " x " +
                     std::to_string(options.height) + " pixels: " + device.info().name + " allows at most " +
                     std::to_string(limit));
  }
  return device.allocate(options, name);
}

// Between memory that the host sees, in parts, as large as takes it a few milliseconds.
void copy(Device& device, void* target, const void* source, std::size_t size) {
  constexpr std::size_t part = std::size_t{8} << 20;
  for (std::size_t offset = 0; offset < size; offset += part) {
    device.heed();
    std::memcpy(static_cast<std::byte*>(target) + offset, static_cast<const std::byte*>(source) + offset,
                std::min(part, size - offset));
  }
}

// Calls move(staging, offset, bytes) for parts that staging memory has room for.
template <typename Move>
void in_parts(Device& device, std::size_t size, const Move& move) {
  const Memory& staging = device.staging(std::min(std::bit_ceil(std::max(size, least_staging)), most_staging));
  for (std::size_t offset = 0; offset < size; offset += most_staging) {
    move(staging, offset, std::min(most_staging, size - offset));
  }
}

}  // namespace

Buffer::Buffer(Device& device, std::uint64_t size, Place place, const std::string& name)
    : size_(size), memory_(device, allocated(device, size, place, name), name) {}

Image::Image(Device& device, const ImageOptions& options, const std::string& name)
    : options_(options), memory_(device, allocated(device, options, name), name) {}

Buffer upload_bytes(Device& device, std::span<const std::byte> data, const std::string& name) {
  Buffer target(device, data.size(), Place::device, name);
  write_bytes(device, target, data);
  return target;
}

void write_bytes(Device& device, const Buffer& target, std::span<const std::byte> data) {
  if (data.size() > target.size()) {
    throw InputError("buffer holds " + std::to_string(target.size()) + " bytes, got " + std::to_string(data.size()));
  }
  if (data.empty()) return;
  if (target.mapped() != nullptr) return copy(device, target.mapped(), data.data(), data.size());
  device.heed();
  if (data.size() <= largest_update && data.size() % 4 == 0) {
    device.update(target.memory(), data);
    return;
  }
  in_parts(device, data.size(), [&](const Memory& staging, std::size_t offset, std::size_t bytes) {
    std::memcpy(staging.mapped, data.data() + offset, bytes);
    Commands commands(device);
    commands.copy(staging, target, offset, bytes);
    commands.submit_and_wait();
  });
}

void read_bytes(Device& device, const Buffer& source, std::span<std::byte> target) {
  if (target.size() > source.size()) {
    throw InputError("buffer holds " + std::to_string(source.size()) + " bytes, asked for " +
                     std::to_string(target.size()));
  }
  if (target.empty()) return;
  if (source.mapped() != nullptr) return copy(device, target.data(), source.mapped(), target.size());
  in_parts(device, target.size(), [&](const Memory& staging, std::size_t offset, std::size_t bytes) {
    Commands commands(device);
    commands.copy(source, offset, staging, bytes);
    commands.submit_and_wait();
    std::memcpy(target.data() + offset, staging.mapped, bytes);
  });
}

}  // namespace quadgraph::device
