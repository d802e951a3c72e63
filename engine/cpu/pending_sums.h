// Sums in memory that a thread adds to later, so that it seldom waits for the memory of others: additions of
// fixed-point numbers give the same bits in any order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace quadgraph::cpu {

// A sum of three numbers, each of them of two words, the low one first (shaders/source/fixed_point.glsl).
constexpr std::size_t channels_of_sum = 3, words_of_sum = 2 * channels_of_sum;

// What is to be added to a sum.
struct PendingSum {
  std::uint32_t* target = nullptr;
  std::array<std::uint64_t, channels_of_sum> value{};
};

// What one thread has still to add. Shaders do so by engine/cpu/pending_add.h.
class PendingSums {
 public:
  // Of this thread.
  static PendingSums& of_thread();

  // A quarter of a MiB: a ray meets some twenty vertices, and those beside it the same.
  static constexpr std::size_t place_count = 8192;

  PendingSum* places() { return places_.data(); }

  // Puts `target` into a place that has another, which is added to memory.
  void replace(PendingSum& place, std::uint32_t* target);

  // Adds all to memory.
  void write();

 private:
  std::vector<PendingSum> places_ = std::vector<PendingSum>(place_count);
  std::vector<PendingSum*> used_;
};

}  // namespace quadgraph::cpu
