#include "engine/vk/survey.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/vk/context.h"

using namespace quadgraph;

TEST_CASE("the device that is opened is the first that a survey finds usable, with the same names") {
  const std::vector<vk::Surveyed> found = vk::survey();
  const auto usable = [](const vk::Surveyed& each) { return each.lacks.empty(); };
  const auto first = std::find_if(found.begin(), found.end(), usable);
  REQUIRE(first != found.end());
  const vk::Context opened;
  CHECK(opened.info().name == first->name);
  CHECK(opened.info().driver == first->driver);
  CHECK(opened.info().cpu == first->software);
}
