// The speed limit of passes that only move memory.
#pragma once

#include <cstdint>

#include "engine/device/device.h"

namespace quadgraph::device {

struct CopyBandwidth {
  double gb_per_s = 0;      // read and written, 1e9 bytes, of the faster of the two ways, at its best
  double kernel = 0;        // GB/s of a compute pass that copies 16 bytes at a time
  double transfer = 0;      // GB/s of the device's own copy
  std::uint64_t bytes = 0;  // of each of the two buffers
};

// Several times the last cache of a GPU; less on the processor, where that much takes seconds.
std::uint64_t default_copy_bytes(const Device& device);

// Copies `bytes`, a positive multiple of 16, from one device buffer to another, each way `repeats` > 0 times after one
// for warmth. Throws DeviceError where the device has no such buffers.
CopyBandwidth copy_bandwidth(Device& device, std::uint64_t bytes, std::uint32_t repeats = 3);

}  // namespace quadgraph::device
