// A compute pass through the whole layer: upload, addresses in push constants, dispatch, read-back, validation silent.
#include <doctest/doctest.h>

#include <chrono>

#include "engine/base/error.h"
#include "engine/device/commands.h"
#include "engine/vk/context.h"
#include "interface/material/evaluate_material.comp.h"
#include "shaders/material/material.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

namespace {

gpu::Material veined() {
  return {.sigma_s_prime = {2.19f, 2.62f, 3.00f},
          .sigma_a = {0.0021f, 0.0041f, 0.0071f},
          .eta = 1.5f,
          .pattern = gpu::PATTERN_VEINS,
          .second_sigma_s_prime = {1.0f, 1.2f, 1.1f},
          .second_sigma_a = {0.05f, 0.04f, 0.06f},
          .period = 20.0f,
          .sharpness = 4.0f,
          .g = {},
          .second_g = {}};
}

}  // namespace

TEST_CASE("a material evaluated on the GPU equals the same code on the CPU") {
  vk::Context context(test_vulkan_device());
  std::vector<glm::vec3> nodes;
  for (int i = 0; i < 1000; ++i) {
    nodes.emplace_back(0.31f * static_cast<float>(i) - 150.0f, 7.0f - 0.17f * static_cast<float>(i),
                       0.05f * static_cast<float>(i * i % 911));
  }
  {
    const auto node_buffer = device::upload<glm::vec3>(context, nodes, "nodes");
    const device::Buffer optical(context, nodes.size() * sizeof(gpu::Optical), device::Place::device, "optical");
    const device::ComputePass pass(context, shader::evaluate_material);
    device::Commands commands(context, 1);
    commands.begin_pass("material");
    commands.dispatch(pass,
                      gpu::EvaluateMaterialPush{veined(), node_buffer.address(), 0, optical.address(),
                                                static_cast<std::uint32_t>(nodes.size())},
                      nodes.size());
    commands.end_pass();
    const auto times = commands.submit_and_wait();
    REQUIRE(times.size() == 1);
    CHECK(times[0].name == "material");
    CHECK(times[0].time_ms >= 0);

    const auto values = device::download<gpu::Optical>(context, optical);
    float spread = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const gpu::Optical expected = gpu::material_at(veined(), nodes[i], 0);
      for (int c = 0; c < 3; ++c) {
        CHECK(values[i].sigma_s_prime[c] == doctest::Approx(expected.sigma_s_prime[c]).epsilon(1e-3));
        CHECK(values[i].sigma_a[c] == doctest::Approx(expected.sigma_a[c]).epsilon(1e-3));
      }
      spread = std::max(spread, std::abs(values[i].sigma_a[0] - values[0].sigma_a[0]));
    }
    CHECK(spread > 0.01f);
    CHECK(context.allocated_bytes() >= nodes.size() * (sizeof(glm::vec3) + sizeof(gpu::Optical)));
  }
  CHECK(context.allocated_bytes() == context.allocated_by_purpose().at("staging"));
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("a device that does not exist is named in the error, with those that do") {
  CHECK_THROWS_WITH_AS(vk::Context({.validation = false, .device = "no such device"}),
                       doctest::Contains("no such device"), DeviceError);
}

TEST_CASE("every pass takes time, together no more than went by") {
  vk::Context context(test_vulkan_device());
  {
    constexpr std::uint32_t few = 1000, many = 1000000;
    const device::Buffer nodes(context, many * sizeof(glm::vec3), device::Place::device, "nodes");
    const device::Buffer optical(context, many * sizeof(gpu::Optical), device::Place::device, "optical");
    const device::ComputePass pass(context, shader::evaluate_material);
    device::Commands commands(context, 2);
    const auto start = std::chrono::steady_clock::now();
    commands.fill(nodes, 0);
    for (const std::uint32_t count : {few, many}) {
      commands.begin_pass("material");
      commands.dispatch(pass, gpu::EvaluateMaterialPush{veined(), nodes.address(), 0, optical.address(), count}, count);
      commands.end_pass();
    }
    const auto times = commands.submit_and_wait();
    const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - start;
    REQUIRE(times.size() == 2);
    for (const auto& pass_time : times) {
      CHECK(pass_time.name == "material");
      CHECK(pass_time.time_ms > 0);
    }
    CHECK(times[0].time_ms + times[1].time_ms <= passed.count());
  }
  for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
}
