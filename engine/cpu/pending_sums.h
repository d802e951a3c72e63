// Sums in memory that a thread adds to later, so that it seldom waits for the memory of others: additions of
// fixed-point numbers give the same bits in any order.
#pragma once

#include <array>
#include <cstdint>

#include "engine/cpu/glsl.h"

namespace quadgraph::cpu::QG_LEVEL {

// What one thread adds to sums of three numbers (shaders/source/fixed_point.glsl), each of them of two words: three low
// words, then three high ones. The last so many sums are kept here; all are in memory when this object is gone.
class PendingSums {
 public:
  PendingSums() = default;
  PendingSums(const PendingSums&) = delete;
  PendingSums& operator=(const PendingSums&) = delete;
  ~PendingSums() {
    for (Sum& sum : sums_) write(sum);
  }

  // Adds whole numbers from 0 to 2^63.
  void add(uint* target, vec3 value) {
    Sum& sum = sums_[reinterpret_cast<std::uintptr_t>(target) / (words * sizeof(uint)) % sums_.size()];
    if (sum.target != target) {
      write(sum);
      sum = {target, {}};
    }
    for (std::size_t c = 0; c < channels; ++c)
      sum.value[c] += static_cast<std::uint64_t>(static_cast<std::int64_t>(value[c]));
  }

 private:
  static constexpr std::size_t channels = 3, words = 2 * channels;
  struct Sum {
    uint* target = nullptr;
    std::array<std::uint64_t, channels> value{};
  };

  static void write(const Sum& sum) {
    if (sum.target == nullptr) return;
    for (std::size_t c = 0; c < channels; ++c) {
      if (sum.value[c] == 0) continue;
      const auto low = static_cast<uint>(sum.value[c]);
      const uint carried =
          static_cast<uint>(sum.value[c] >> 32) + (atomicAdd(sum.target[c], low) + low < low ? 1u : 0u);
      if (carried != 0) atomicAdd(sum.target[channels + c], carried);
    }
  }

  std::array<Sum, 1024> sums_;
};

}  // namespace quadgraph::cpu::QG_LEVEL
