// Sums that a thread keeps back: whole once they are written, also where more are kept than there are places.
#include <doctest/doctest.h>

#include <thread>
#include <vector>

#include "tests/cpp/fixtures/shader_functions.h"

using namespace quadgraph;

namespace {

constexpr std::size_t sum_count = 3 * cpu::PendingSums::place_count + 5;

// Adds (number, 2, 2^33) to each of the sums in turn, three times.
void add_to_all(std::vector<std::uint64_t>& memory) {
  cpu::PendingSums& sums = cpu::PendingSums::of_thread();
  for (int round = 0; round < 3; ++round) {
    for (std::size_t k = 0; k < sum_count; ++k) {
      auto* target = reinterpret_cast<std::uint32_t*>(memory.data()) + cpu::words_of_sum * k;
      cpu::tested::add_later(sums, target, cpu::tested::vec3(static_cast<float>(k), 2.0f, 0x1p33f));
    }
  }
  sums.write();
}

}  // namespace

TEST_CASE("sums of two threads are whole, and what was written is not added again") {
  std::vector<std::uint64_t> memory(cpu::channels_of_sum * sum_count);
  {
    const std::jthread other(add_to_all, std::ref(memory));
    add_to_all(memory);
  }
  cpu::PendingSums::of_thread().write();
  for (std::size_t k = 0; k < sum_count; ++k) {
    CAPTURE(k);
    REQUIRE(memory[3 * k] == 6 * k);
    REQUIRE(memory[3 * k + 1] == 12);
    REQUIRE(memory[3 * k + 2] == 6ull << 33);
  }
}
