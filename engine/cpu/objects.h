// Buffers, images and passes of the processor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/device/device.h"

namespace quadgraph::cpu {

struct Freed {
  void operator()(void* memory) const;
};
using Bytes = std::unique_ptr<void, Freed>;

// Aligned for the widest instructions. Throws DeviceError where there is no room.
Bytes bytes(std::uint64_t count);

struct BufferMemory : device::Memory {
  explicit BufferMemory(std::uint64_t size) : memory(bytes(size)) {
    address = reinterpret_cast<std::uint64_t>(memory.get());
    mapped = memory.get();
    allocated = size;
  }
  Bytes memory;
};

// One layer after the other, rows tightly packed.
struct ImageMemory : device::ImageMemory {
  explicit ImageMemory(const device::ImageOptions& wanted) : options(wanted), memory(bytes(bytes_of(wanted))) {
    address = reinterpret_cast<std::uint64_t>(memory.get());
    allocated = bytes_of(wanted);
  }

  static std::uint64_t bytes_of(const device::ImageOptions& image) {
    return std::uint64_t{device::texel_bytes(image.format)} * image.width * image.height * image.layers;
  }

  std::uint32_t texel_bytes() const { return device::texel_bytes(options.format); }
  std::uint32_t words() const { return texel_bytes() / 4; }  // of a texel
  float* texels() const { return static_cast<float*>(memory.get()); }

  // Before each draw into it, of `width` x `height` texels in `tiles` tiles.
  void start_draw(std::uint32_t width, std::uint32_t height, std::uint32_t tiles) {
    if (width != drawn_width || height != drawn_height) clear_tiles.assign(tiles, 0);
    drawn_width = width;
    drawn_height = height;
  }

  device::ImageOptions options;
  Bytes memory;
  std::uint32_t drawn_width = 0, drawn_height = 0;
  std::vector<char> clear_tiles;  // whether the last draw left nothing in a tile; draws alone write to an image
};

struct ComputePipeline : device::Pipeline {
  ComputePipeline(device::ComputeKernel made, std::uint32_t kind) : kernel(made), variant(kind) {}
  device::ComputeKernel kernel;
  std::uint32_t variant;
};

struct GraphicsPipeline : device::Pipeline {
  GraphicsPipeline(const device::GraphicsOptions& wanted, std::size_t level)
      : options(wanted),
        vertex(wanted.vertex->cpu.vertex[level]),
        fragment(wanted.fragment == nullptr ? nullptr : wanted.fragment->cpu.fragment[level]) {}
  device::GraphicsOptions options;
  device::VertexKernel vertex;
  device::FragmentKernel fragment;  // null: depth only
};

}  // namespace quadgraph::cpu
