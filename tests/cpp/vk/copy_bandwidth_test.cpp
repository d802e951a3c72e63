// The measured speed of copying, and that the pass it is measured with copies.
#include "engine/device/copy_bandwidth.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/device/commands.h"
#include "engine/vk/context.h"
#include "interface/shared/copy.comp.h"
#include "shaders/shared/shared.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

TEST_CASE("copying: positive both ways, the faster one counts, and all memory is given back") {
  vk::Context context(test_vulkan_device());
  constexpr std::uint64_t bytes = 8u << 20;
  const device::CopyBandwidth copied = device::copy_bandwidth(context, bytes, 2);
  CHECK(copied.kernel > 0);
  CHECK(copied.transfer > 0);
  CHECK(copied.gb_per_s == std::max(copied.kernel, copied.transfer));
  CHECK(copied.bytes == bytes);
  CHECK(context.allocated_bytes() == 0);
  CHECK(context.peak_allocated_bytes() >= 2 * bytes);
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("the pass copies every element and nothing beyond") {
  vk::Context context(test_vulkan_device());
  std::vector<glm::uvec4> values(1000);
  for (std::uint32_t i = 0; i < values.size(); ++i) values[i] = glm::uvec4(i, 3 * i, ~i, 7);
  const auto source = device::upload<glm::uvec4>(context, values, "source");
  const auto target = device::upload<glm::uvec4>(context, std::vector<glm::uvec4>(1001, glm::uvec4(9)), "target");
  const device::ComputePass pass(context, shader::copy);
  device::Commands commands(context);
  commands.dispatch(pass, gpu::CopyPush{source.address(), target.address(), 1000, 512}, 512);
  commands.submit_and_wait();
  const auto copied = device::download<glm::uvec4>(context, target);
  CHECK(std::equal(values.begin(), values.end(), copied.begin()));
  CHECK(copied.back() == glm::uvec4(9));
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}
