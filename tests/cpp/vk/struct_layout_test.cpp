// The structs that shaders share with C++ lie in memory as the compiled shaders read them: offsets of members, and
// strides of the arrays they form. The build lists them all (tools/shader_headers).
#include <doctest/doctest.h>

#include <map>
#include <set>
#include <string>

#include "interface/all_shaders.h"
#include "tests/cpp/fixtures/spirv_layout.h"

using namespace quadgraph;

namespace {

using Members = std::map<std::string, std::uint32_t>;

// Calls visit(code, MOMENTS) for all that is compiled.
template <typename Visit>
void for_all_codes(Visit visit) {
  for (const device::Shader* shader : all_shaders) {
    CAPTURE(shader->name);
    visit(shader->code, 1);
    if (!shader->sp3.empty()) visit(shader->sp3, 2);
  }
}

// Bytes of the elements of arrays that hold no struct of C++.
std::map<std::string, std::size_t> strides(int moments) {
  return {{"Floats", sizeof(float)},
          {"Uints", sizeof(std::uint32_t)},
          {"Uvec2s", sizeof(glm::uvec2)},
          {"Vec2s", sizeof(glm::vec2)},
          {"Vec3s", sizeof(glm::vec3)},
          {"Vec4s", sizeof(glm::vec4)},
          {"Uvec3s", sizeof(glm::uvec3)},
          {"Uvec4s", sizeof(glm::uvec4)},
          {"Reduction", sizeof(glm::vec3)},
          {"Fields", moments * sizeof(glm::vec3)},
          {"Entries", (moments == 2 ? 3 : 1) * sizeof(glm::vec3)}};
}

}  // namespace

TEST_CASE("members of structs lie where shaders read them, and arrays of them have their size as stride") {
  std::set<std::string> seen;
  for_all_codes([&](device::Spirv code, int) {
    const SpirvLayout layout(code);
    for (const StructLayout& expected : struct_layouts) {
      const auto found = layout.offset.find(expected.name);
      if (found == layout.offset.end()) continue;
      CAPTURE(expected.name);
      CHECK(found->second == Members(expected.offsets.begin(), expected.offsets.end()));
      const auto stride = layout.stride.find(expected.name);
      if (stride != layout.stride.end()) CHECK(stride->second == expected.size);
      seen.insert(expected.name);
    }
  });
  CHECK(seen.size() > 100);
  for (const StructLayout& expected : struct_layouts) CHECK_MESSAGE(seen.count(expected.name) == 1, expected.name);
}

TEST_CASE("arrays of numbers have the stride of their C++ element") {
  std::set<std::string> seen;
  for_all_codes([&](device::Spirv code, int moments) {
    const SpirvLayout layout(code);
    for (const auto& [block, bytes] : strides(moments)) {
      const auto found = layout.block_stride.find(block);
      if (found == layout.block_stride.end()) continue;
      CAPTURE(block);
      CHECK(found->second == bytes);
      seen.insert(block + std::to_string(moments));
    }
  });
  for (const auto& [block, bytes] : strides(1)) CHECK_MESSAGE(seen.count(block + "1") == 1, block);
  for (const char* block : {"Fields2", "Entries2"}) CHECK_MESSAGE(seen.count(block) == 1, block);
}

TEST_CASE("push constants fit where every device of Vulkan 1.3 has room for them") {
  for (const device::Shader* shader : all_shaders) CHECK_MESSAGE(shader->push_size <= 128, shader->name);
}

TEST_CASE("a reduction starts with its ticket") {
  const SpirvLayout layout(shader::cg_start.code);
  CHECK(layout.offset.at("Reduction").at("ticket") == 0);
  CHECK(layout.offset.at("Reduction").at("partials") == 4);
}
