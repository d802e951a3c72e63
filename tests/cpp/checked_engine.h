// An engine on the file of a cube of 2 mm with two levels, whose validation messages fail the test.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>

#include "engine/render/engine.h"

struct CheckedEngine {
  quadgraph::Engine engine{std::filesystem::path(QUADGRAPH_TEST_DATA) / "tiny.qgraph",
                           {.validation = true, .device = ""}};

  CheckedEngine() = default;
  CheckedEngine(const CheckedEngine&) = delete;
  CheckedEngine& operator=(const CheckedEngine&) = delete;
  ~CheckedEngine() {
    for (const auto& message : engine.context().validation_messages()) FAIL_CHECK(message);
  }
};
