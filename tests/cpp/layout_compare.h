// Compares members of a struct in compiled SPIR-V with offsetof in C++.
#pragma once

#include <doctest/doctest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "engine/vk/pipeline.h"
#include "tests/cpp/spirv_layout.h"

namespace quadgraph {

struct Member {
  const char* name;
  std::size_t offset;
};

inline void compare(vk::Spirv code, const std::string& type, const std::vector<Member>& members) {
  CAPTURE(type);
  const SpirvLayout layout(code);
  const auto found = layout.offset.find(type);
  REQUIRE(found != layout.offset.end());
  CHECK(found->second.size() == members.size());
  for (const Member& member : members) {
    CAPTURE(member.name);
    REQUIRE(found->second.count(member.name) == 1);
    CHECK(found->second.at(member.name) == member.offset);
  }
}

#define MEMBER(Type, name) {#name, offsetof(gpu::Type, name)}

}  // namespace quadgraph
