// The surroundings that are built in.
#include "engine/render/light/studio.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "engine/base/error.h"
#include "engine/render/light/environment.h"
#include "engine/render/light/lights.h"

using namespace quadgraph;

TEST_CASE("the studio is a room of soft-boxes without peaks, brightest behind the object") {
  const Image picture = studio_picture();
  REQUIRE(picture.texels.size() == std::size_t{picture.width} * picture.height);
  const auto brightest = std::max_element(picture.texels.begin(), picture.texels.end(),
                                          [](const glm::vec3& a, const glm::vec3& b) { return a.y < b.y; });
  const auto at = static_cast<std::uint32_t>(brightest - picture.texels.begin());
  const std::uint32_t column = at % picture.width, row = at / picture.width;
  CHECK(column > picture.width / 4);
  CHECK(column < picture.width / 2);  // ahead, to the left
  CHECK(row < picture.height / 2);    // above the horizon
  CHECK(brightest->x > brightest->z);
  for (const glm::vec3& texel : picture.texels) CHECK(std::min({texel.x, texel.y, texel.z}) > 0);
  CHECK(environment_of(picture).suns.empty());
}

TEST_CASE("its name stands for a light and for an environment's file, and for no file of a projector") {
  CHECK(parse_light("studio") == parse_light(studio_light));
  CHECK(parse_light(to_string(parse_light("studio"))) == parse_light("studio"));
  CHECK(environment_picture("studio").texels == studio_picture().texels);
  CHECK(environment_pyramid("studio") == environment_pyramid("studio"));
  CHECK_THROWS_WITH_AS(environment_picture("studios"), doctest::Contains("studios"), InputError);
}
