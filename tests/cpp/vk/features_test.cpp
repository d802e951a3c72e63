// The features that are required of a device are those that something needs: compiled shaders say themselves what.
#include "engine/vk/features.h"

#include <doctest/doctest.h>

#include <map>
#include <optional>
#include <set>
#include <string>

#include "interface/all_shaders.h"

using namespace quadgraph;

namespace {

using Names = std::set<std::string>;

// What the calls of engine/vk and engine/render need, which no shader tells.
const Names by_calls = {"dynamicRendering", "synchronization2", "hostQueryReset"};

// The feature of a SPIR-V capability; empty where every device of Vulkan 1.3 has it, nothing where it is not known
// here.
std::optional<std::string> feature_of_capability(std::uint32_t capability) {
  static const std::map<std::uint32_t, std::string> known = {
      {1, ""},  // Shader
      {2, "geometryShader"},
      {3, "tessellationShader"},
      {9, "shaderFloat16"},
      {10, "shaderFloat64"},
      {11, "shaderInt64"},
      {22, "shaderInt16"},
      {39, "shaderInt8"},
      {47, ""},  // ImageBuffer
      {5347, "bufferDeviceAddress"},
  };
  const auto found = known.find(capability);
  return found == known.end() ? std::nullopt : std::optional(found->second);
}

// What a module declares, and what layout and workgroup size it has.
Names features_of(device::Spirv code) {
  constexpr std::uint32_t local_size_id = 38, array_stride = 6;
  Names names;
  std::set<std::uint32_t> vectors_of_three, arrays_of_vectors;
  std::map<std::uint32_t, std::uint32_t> stride;
  // Five words of header, then instructions: word count in the high half, opcode in the low half.
  for (std::size_t i = 5; i < code.size(); i += code[i] >> 16) {
    const auto* op = &code[i];
    switch (op[0] & 0xffffu) {
      case 17: {  // OpCapability capability
        const auto feature = feature_of_capability(op[1]);
        CAPTURE(op[1]);
        REQUIRE(feature);
        if (!feature->empty()) names.insert(*feature);
        break;
      }
      case 331:  // OpExecutionModeId entry, mode
        if (op[2] == local_size_id) names.insert("maintenance4");
        break;
      case 23:  // OpTypeVector result, component, count
        if (op[3] == 3) vectors_of_three.insert(op[1]);
        break;
      case 29:  // OpTypeRuntimeArray result, element
        if (vectors_of_three.count(op[2]) > 0) arrays_of_vectors.insert(op[1]);
        break;
      case 71:  // OpDecorate target, decoration, value
        if (op[2] == array_stride) stride[op[1]] = op[3];
        break;
      default:
        break;
    }
  }
  for (const std::uint32_t array : arrays_of_vectors) {
    if (stride.at(array) == 12) names.insert("scalarBlockLayout");  // without it 16
  }
  return names;
}

Names by_shaders() {
  Names all;
  for (const device::Shader* shader : all_shaders) {
    CAPTURE(shader->name);
    for (const device::Spirv code : {shader->code, shader->sp3}) {
      if (!code.empty()) all.merge(features_of(code));
    }
  }
  return all;
}

}  // namespace

TEST_CASE("what is required of a device is what shaders and calls need, each once") {
  Names needed = by_shaders();
  for (const std::string& name : by_calls) CHECK_MESSAGE(needed.insert(name).second, name);
  vk::Features features;
  Names required;
  for (const auto& [name, value] : features.required()) CHECK_MESSAGE(required.insert(name).second, name);
  for (const std::string& name : needed) CHECK_MESSAGE(required.count(name) == 1, name, " is needed, not required");
  for (const std::string& name : required) CHECK_MESSAGE(needed.count(name) == 1, name, " is required, not needed");
}
