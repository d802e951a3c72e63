// A device with validation, for tests.
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <optional>

#include "engine/vk/context.h"

namespace quadgraph {

// A context whose validation messages fail the test that made it.
struct CheckedContext {
  vk::Context context;

  // `texel_bytes`: vk::ContextOptions.
  explicit CheckedContext(std::optional<std::uint64_t> texel_bytes = std::nullopt)
      : context({.validation = true, .device = "", .texel_bytes = texel_bytes}) {}
  CheckedContext(const CheckedContext&) = delete;
  CheckedContext& operator=(const CheckedContext&) = delete;
  ~CheckedContext() {
    for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
  }
};

}  // namespace quadgraph
