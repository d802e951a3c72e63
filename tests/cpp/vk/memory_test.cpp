// Buffers: contents, bookkeeping and limits.
#include <doctest/doctest.h>

#include <numeric>

#include "engine/base/error.h"
#include "engine/device/commands.h"
#include "engine/device/live_objects.h"
#include "engine/vk/context.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

namespace {

// Bytes of buffers and images, but for the staging memory, which is kept.
std::uint64_t in_use(const device::Device& device) {
  const auto staging = device.allocated_by_purpose().find("staging");
  return device.allocated_bytes() - (staging == device.allocated_by_purpose().end() ? 0 : staging->second);
}

}  // namespace

TEST_CASE("a buffer larger than the device allows is refused by name, without allocating") {
  vk::Context context(test_vulkan_device());
  const std::uint64_t size = context.max_buffer_bytes() + 4;
  REQUIRE(context.max_buffer_bytes() > 0);
  CHECK_THROWS_WITH_AS(device::Buffer(context, size, device::Place::device, "level 7 weight"),
                       doctest::Contains("level 7 weight"), DeviceError);
  CHECK(in_use(context) == 0);
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("contents survive a round trip, and reads and writes stay within a buffer") {
  vk::Context context(test_vulkan_device());
  {
    std::vector<std::uint32_t> values(1001);
    std::iota(values.begin(), values.end(), 7u);
    const auto buffer = device::upload<std::uint32_t>(context, values, "values");
    CHECK(device::download<std::uint32_t>(context, buffer) == values);
    const std::vector<std::uint32_t> front = {1, 2, 3};
    device::write_bytes(context, buffer, std::as_bytes(std::span(front)));
    std::copy(front.begin(), front.end(), values.begin());
    CHECK(device::download<std::uint32_t>(context, buffer) == values);
    values.push_back(0);
    CHECK_THROWS_AS(device::write_bytes(context, buffer, std::as_bytes(std::span(values))), InputError);
    CHECK_THROWS_AS(device::read_bytes(context, buffer, std::as_writable_bytes(std::span(values))), InputError);
    const auto empty = device::upload<std::uint32_t>(context, {}, "empty");
    CHECK(empty.size() == 0);
    CHECK(device::download<std::uint32_t>(context, empty).empty());
  }
  CHECK(in_use(context) == 0);
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("moving a buffer moves its memory") {
  vk::Context context(test_vulkan_device());
  {
    device::Buffer first(context, 256, device::Place::device, "first");
    device::Buffer second(context, 1024, device::Place::device, "second");
    const std::uint64_t both = context.allocated_bytes();
    const std::uint64_t address = second.address();
    std::swap(first, second);
    CHECK(first.address() == address);
    CHECK(first.size() == 1024);
    CHECK(context.allocated_bytes() == both);
    second = device::Buffer();
    CHECK(context.allocated_bytes() < both);
  }
  CHECK(in_use(context) == 0);
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("memory is counted by purpose, and every allocation") {
  vk::Context context(test_vulkan_device());
  {
    const device::Buffer first(context, 4096, device::Place::device, "operator/level 0 weight");
    device::Buffer second(context, 8192, device::Place::device, "operator/level 1 weight");
    const device::Image image(context, {}, "picture/samples");
    CHECK(context.allocation_count() == 3);
    const auto& uses = context.allocated_by_purpose();
    REQUIRE(uses.size() == 2);
    CHECK(uses.at("operator") >= 4096 + 8192);
    CHECK(uses.at("operator") + uses.at("picture") == context.allocated_bytes());
    const std::uint64_t both = uses.at("operator");
    second = device::Buffer();
    CHECK(uses.at("operator") <= both - 8192);
  }
  CHECK(context.allocated_by_purpose().empty());
  CHECK(context.allocation_count() == 3);
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("objects are counted by kind, by device, and gone with their owner") {
  const std::uint64_t first = device::devices_opened();
  const device::LiveObjects others = device::live_objects();
  {
    vk::Context context(test_vulkan_device());
    CHECK(device::devices_opened() == first + 1);
    const device::LiveObjects bare = device::live_objects(first);
    CHECK(bare.at("device") == 1);
    CHECK(bare.count("image") == 0);
    {
      const device::Buffer buffer(context, 256, device::Place::device, "buffer");
      const device::Image image(context, {.layers = 2}, "image");
      device::Buffer given(context, 256, device::Place::device, "given");
      const device::Buffer taken = std::move(given);
      device::LiveObjects expected = bare;
      expected["buffer"] += 2;
      expected["image"] = 1;
      expected["image view"] = 2;
      expected["device memory"] += 3;
      expected["allocation"] = 3;
      expected["allocated byte"] = context.allocated_bytes();
      CHECK(device::live_objects(first) == expected);
      CHECK(device::live_objects(first + 1).empty());
    }
    CHECK(device::live_objects(first) == bare);
  }
  CHECK(device::live_objects(first).empty());
  CHECK(device::live_objects() == others);
}
