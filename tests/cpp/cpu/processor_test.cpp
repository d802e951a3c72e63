// What the processor refuses as a device.
#include "engine/cpu/processor.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include "engine/base/error.h"
#include "engine/device/memory.h"

using namespace quadgraph;

TEST_CASE("more than the machine's memory is refused by name before any is taken, at once or in all") {
  cpu::Processor processor;
  const std::uint64_t memory = processor.max_buffer_bytes();
  CHECK(memory == std::uint64_t(sysconf(_SC_PHYS_PAGES)) * std::uint64_t(sysconf(_SC_PAGE_SIZE)));
  const auto allocate = [&](std::uint64_t bytes) {
    return device::Buffer(processor, bytes, device::Place::device, "level 7 weight");
  };
  CHECK_THROWS_WITH_AS(allocate(memory + 4), doctest::Contains("level 7 weight"), DeviceError);
  CHECK_THROWS_WITH_AS(allocate(memory + 4), doctest::Contains(std::to_string(memory).c_str()), DeviceError);
  CHECK(processor.allocated_bytes() == 0);
  const device::Buffer first = allocate(4096);
  CHECK_THROWS_WITH_AS(allocate(memory - 4096), doctest::Contains("bytes are in use"), DeviceError);
  CHECK(processor.allocation_count() == 1);
  const std::uint32_t side = processor.max_image_side();
  const auto layers = static_cast<std::uint32_t>(memory / (std::uint64_t{16} * side * side) + 1);
  CHECK_THROWS_AS(device::Image(processor, {.width = side, .height = side, .layers = layers}, "picture"), DeviceError);
  CHECK(processor.allocation_count() == 1);
}
