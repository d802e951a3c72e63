// Devices that are not here: what they are said to lack, and that no shader asks for more than those offer that are
// said to lack nothing.
#include <doctest/doctest.h>

#include <fstream>
#include <map>
#include <numeric>
#include <sstream>

#include "engine/vk/features.h"
#include "interface/all_shaders.h"
#include "tests/cpp/fixtures/test_data.h"

using namespace quadgraph;

namespace {

using Recorded = std::map<std::string, std::string>;

// Of lines NAME: VALUE; the first of a device is its name.
std::vector<Recorded> recorded_devices() {
  std::ifstream file(test_data("vulkan_devices.txt"));
  REQUIRE(file);
  std::vector<Recorded> devices;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    const std::size_t colon = line.find(':');
    REQUIRE(colon != std::string::npos);
    const std::string name = line.substr(0, colon);
    if (name == "device") devices.emplace_back();
    devices.back()[name] = colon + 2 < line.size() ? line.substr(colon + 2) : "";
  }
  return devices;
}

std::uint32_t number(const Recorded& device, const char* name) {
  return static_cast<std::uint32_t>(std::stoul(device.at(name)));
}

VkPhysicalDeviceLimits limits_of(const Recorded& device) {
  VkPhysicalDeviceLimits limits{};
  limits.maxComputeWorkGroupInvocations = number(device, "maxComputeWorkGroupInvocations");
  limits.maxComputeWorkGroupSize[0] = number(device, "maxComputeWorkGroupSize[0]");
  return limits;
}

void set_features(const Recorded& device, vk::Features& features) {
  for (const auto& [name, value] : features.required()) *value = device.at("features") == "all" ? VK_TRUE : VK_FALSE;
  if (device.at("features") == "all") return;
  std::istringstream names(device.at("features"));
  for (std::string offered; names >> offered;) {
    bool known = false;
    for (const auto& [name, value] : features.required()) {
      if (offered != name) continue;
      *value = VK_TRUE;
      known = true;
    }
    CHECK_MESSAGE(known, offered);
  }
}

// Bytes that the workgroups of a module share.
std::uint32_t shared_bytes(device::Spirv code) {
  constexpr std::uint32_t workgroup = 4;
  std::map<std::uint32_t, std::uint32_t> size, constant, pointed;
  std::uint32_t bytes = 0;
  for (std::size_t i = 5; i < code.size(); i += code[i] >> 16) {
    const auto* op = &code[i];
    switch (op[0] & 0xffffu) {
      case 20:  // OpTypeBool, OpTypeInt, OpTypeFloat result
      case 21:
      case 22:
        size[op[1]] = 4;
        break;
      case 23:  // OpTypeVector result, component, count
        size[op[1]] = size[op[2]] * op[3];
        break;
      case 28:  // OpTypeArray result, element, length
        size[op[1]] = size[op[2]] * constant[op[3]];
        break;
      case 30:  // OpTypeStruct result, members
        size[op[1]] = std::accumulate(op + 2, op + (op[0] >> 16), 0u, [&](auto sum, auto m) { return sum + size[m]; });
        break;
      case 32:  // OpTypePointer result, class, type
        pointed[op[1]] = op[3];
        break;
      case 43:  // OpConstant, OpSpecConstant type, result, value
      case 50:
        constant[op[2]] = op[3];
        break;
      case 59:  // OpVariable type, result, class
        if (op[3] == workgroup) bytes += size[pointed[op[1]]];
        break;
      default:
        break;
    }
  }
  return bytes;
}

}  // namespace

TEST_CASE("of a recorded device is said what it lacks") {
  for (const Recorded& device : recorded_devices()) {
    CAPTURE(device.at("device"));
    vk::Features features;
    set_features(device, features);
    CHECK(vk::lacking(features, limits_of(device)) == device.at("lacks"));
  }
}

TEST_CASE("no shader asks for more than a device has that lacks nothing") {
  std::uint32_t pushed = 0, shared = 0;
  for (const device::Shader* shader : all_shaders) {
    pushed = std::max(pushed, shader->push_size);
    for (const device::Spirv code : {shader->code, shader->sp3}) {
      if (!code.empty()) shared = std::max(shared, shared_bytes(code));
    }
  }
  CHECK(shared > 10000);  // of path_relax
  int able = 0;
  for (const Recorded& device : recorded_devices()) {
    if (!device.at("lacks").empty()) continue;
    CAPTURE(device.at("device"));
    ++able;
    CHECK(pushed <= number(device, "maxPushConstantsSize"));
    CHECK(shared <= number(device, "maxComputeSharedMemorySize"));
  }
  CHECK(able >= 5);
}
