// Buffers: contents, bookkeeping and limits.
#include <doctest/doctest.h>

#include <numeric>

#include "engine/base/error.h"
#include "engine/vk/arena.h"
#include "engine/vk/commands.h"

using namespace quadgraph;

TEST_CASE("a buffer larger than the device allows is refused by name, without allocating") {
  vk::Context context({.validation = true, .device = ""});
  const std::uint64_t size = context.max_buffer_bytes() + 4;
  REQUIRE(context.max_buffer_bytes() > 0);
  CHECK_THROWS_WITH_AS(vk::Buffer(context, size, vk::Place::device, "level 7 weight"),
                       doctest::Contains("level 7 weight"), VulkanError);
  CHECK(context.allocated_bytes() == 0);
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("contents survive a round trip, and reads and writes stay within a buffer") {
  vk::Context context({.validation = true, .device = ""});
  {
    std::vector<std::uint32_t> values(1001);
    std::iota(values.begin(), values.end(), 7u);
    const auto buffer = vk::upload<std::uint32_t>(context, values, "values");
    CHECK(vk::download<std::uint32_t>(context, buffer) == values);
    const std::vector<std::uint32_t> front = {1, 2, 3};
    vk::write_bytes(context, buffer, std::as_bytes(std::span(front)));
    std::copy(front.begin(), front.end(), values.begin());
    CHECK(vk::download<std::uint32_t>(context, buffer) == values);
    values.push_back(0);
    CHECK_THROWS_AS(vk::write_bytes(context, buffer, std::as_bytes(std::span(values))), InputError);
    CHECK_THROWS_AS(vk::read_bytes(context, buffer, std::as_writable_bytes(std::span(values))), InputError);
    const auto empty = vk::upload<std::uint32_t>(context, {}, "empty");
    CHECK(empty.size() == 0);
    CHECK(vk::download<std::uint32_t>(context, empty).empty());
  }
  CHECK(context.allocated_bytes() == 0);
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("moving a buffer moves its memory") {
  vk::Context context({.validation = true, .device = ""});
  {
    vk::Buffer first(context, 256, vk::Place::device, "first");
    vk::Buffer second(context, 1024, vk::Place::device, "second");
    const std::uint64_t both = context.allocated_bytes();
    const VkDeviceAddress address = second.address();
    std::swap(first, second);
    CHECK(first.address() == address);
    CHECK(first.size() == 1024);
    CHECK(context.allocated_bytes() == both);
    second = vk::Buffer();
    CHECK(context.allocated_bytes() < both);
  }
  CHECK(context.allocated_bytes() == 0);
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("memory is counted by purpose, and every allocation") {
  vk::Context context({.validation = true, .device = ""});
  {
    const vk::Buffer first(context, 4096, vk::Place::device, "operator/level 0 weight");
    vk::Buffer second(context, 8192, vk::Place::device, "operator/level 1 weight");
    const vk::Image image(context, {.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT}, "picture/samples");
    CHECK(context.allocation_count() == 3);
    const auto& uses = context.allocated_by_purpose();
    REQUIRE(uses.size() == 2);
    CHECK(uses.at("operator") >= 4096 + 8192);
    CHECK(uses.at("operator") + uses.at("picture") == context.allocated_bytes());
    const std::uint64_t both = uses.at("operator");
    second = vk::Buffer();
    CHECK(uses.at("operator") <= both - 8192);
  }
  CHECK(context.allocated_by_purpose().empty());
  CHECK(context.allocation_count() == 3);
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("ranges of the arena are given back and taken again, and the first that does not fit ends it") {
  vk::Context context({.validation = true, .device = "", .texel_bytes = 1 << 16});
  const auto complete = [&](vk::Place place) { return (context.arenas().complete() >> vk::arena_of(place) & 1u) != 0; };
  const auto in_arena = [&](const vk::Buffer& buffer) {
    const VkDeviceAddress begin = context.arenas()[vk::arena_of(vk::Place::read)].address();
    return buffer.address() >= begin && buffer.address() < begin + (1 << 16);
  };
  const auto read = [&](std::uint64_t bytes) { return vk::Buffer(context, bytes, vk::Place::read, "test/read"); };
  {
    vk::Buffer a = read(1 << 14), b = read(1 << 15);
    const vk::Buffer elsewhere(context, 256, vk::Place::device, "test/device");
    CHECK(in_arena(a));
    CHECK(in_arena(b));
    CHECK(!in_arena(elsewhere));
    const std::vector<std::uint32_t> values(100, 7);
    vk::write_bytes(context, b, std::as_bytes(std::span(values)));
    a = read(1 << 13);  // the new one is there before the old one goes
    a = read(1 << 14);
    CHECK(vk::download<std::uint32_t>(context, b)[99] == 7);
    CHECK(complete(vk::Place::read));
  }
  CHECK(context.allocated_bytes() == 0);
  CHECK(in_arena(read(1 << 16)));  // all of it, in one piece again
  CHECK(complete(vk::Place::read));
  const vk::Buffer large = read((1 << 16) + 4);
  CHECK(!in_arena(large));
  CHECK(!complete(vk::Place::read));
  CHECK(in_arena(read(256)));
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}
