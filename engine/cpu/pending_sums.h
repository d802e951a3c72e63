// Sums in memory that a thread adds to later, so that it seldom waits for the memory of others: additions of
// fixed-point numbers give the same bits in any order.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "engine/cpu/glsl.h"

namespace quadgraph::cpu::QG_LEVEL {

// What one thread adds to sums of three numbers (shaders/source/fixed_point.glsl), each of them of two words, the low
// one first. The last so many sums are kept here; all are in memory when this object is gone.
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
    Sum& sum = sums_[reinterpret_cast<std::uintptr_t>(target) / (words_of_sum * sizeof(uint)) % sums_.size()];
    if (sum.target != target) {
      write(sum);
      sum = {target, {}};
    }
    for (std::size_t c = 0; c < channels; ++c)
      sum.value[c] += static_cast<std::uint64_t>(static_cast<std::int64_t>(value[c]));
  }

 private:
  static constexpr std::size_t channels = 3, words_of_sum = 2 * channels;
  static_assert(std::endian::native == std::endian::little);
  struct Sum {
    uint* target = nullptr;
    std::array<std::uint64_t, channels> value{};
  };

  static void write(const Sum& sum) {
    if (sum.target == nullptr) return;
    auto* words = reinterpret_cast<std::uint64_t*>(sum.target);  // buffers are aligned, and so are sums
    for (std::size_t c = 0; c < channels; ++c) {
      if (sum.value[c] != 0) __atomic_fetch_add(words + c, sum.value[c], __ATOMIC_RELAXED);
    }
  }

  std::array<Sum, 1024> sums_;
};

}  // namespace quadgraph::cpu::QG_LEVEL
