// A device with validation, for tests.
#pragma once

#include <doctest/doctest.h>

#include "engine/vk/context.h"

namespace quadgraph {

// A context whose validation messages fail the test that made it.
struct CheckedContext {
  vk::Context context{{.validation = true, .device = ""}};

  CheckedContext() = default;
  CheckedContext(const CheckedContext&) = delete;
  CheckedContext& operator=(const CheckedContext&) = delete;
  ~CheckedContext() {
    for (const auto& message : context.validation_messages()) FAIL_CHECK(message);
  }
};

}  // namespace quadgraph
