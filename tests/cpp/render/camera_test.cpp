// Where the camera stands and what it sees.
#include "engine/render/display/camera.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "engine/render/light/default_lights.h"

using namespace quadgraph;

namespace {

const Sphere bounds{{1, 2, 3}, 10};

View view(float azimuth, float elevation, UpAxis up = UpAxis::y, std::optional<float> distance = 50.0f) {
  return {.azimuth = azimuth, .elevation = elevation, .distance = distance, .up = up};
}

glm::vec3 projected(const Camera& camera, const glm::vec3& point) {
  const glm::vec4 clip = camera.clip_from_world * glm::vec4(point, 1);
  return glm::vec3(clip) / clip.w;
}

bool near(const glm::vec3& a, const glm::vec3& b) {
  return glm::distance(a, b) < 1e-4f;
}

}  // namespace

TEST_CASE("the bounding sphere holds every point and is centred on the box") {
  const std::array<glm::vec3, 3> points = {glm::vec3(0, 0, 0), glm::vec3(4, 0, 0), glm::vec3(4, 2, 6)};
  const Sphere sphere = bounding_sphere(points);
  CHECK(sphere.centre == glm::vec3(2, 1, 3));
  CHECK(sphere.radius == doctest::Approx(std::sqrt(14.0f)));
}

TEST_CASE("with y up, azimuth 0 looks along -z, 90 along -x, and elevation looks from above") {
  CHECK(near(place_camera(view(0, 0), bounds, 1).eye, {1, 2, 53}));
  CHECK(near(place_camera(view(90, 0), bounds, 1).eye, {51, 2, 3}));
  CHECK(near(place_camera(view(0, 90), bounds, 1).eye, {1, 52, 3}));
  CHECK(near(place_camera(view(0, 0), bounds, 1).up, {0, 1, 0}));
  CHECK(near(place_camera(view(0, 0), bounds, 1).right, {1, 0, 0}));
}

TEST_CASE("with z up, azimuth 0 looks along +y, 90 along -x") {
  CHECK(near(place_camera(view(0, 0, UpAxis::z), bounds, 1).eye, {1, -48, 3}));
  CHECK(near(place_camera(view(90, 0, UpAxis::z), bounds, 1).eye, {51, 2, 3}));
  CHECK(near(place_camera(view(0, 90, UpAxis::z), bounds, 1).eye, {1, 2, 53}));
  CHECK(near(place_camera(view(0, 0, UpAxis::z), bounds, 1).up, {0, 0, 1}));
}

TEST_CASE("the centre is in the middle of the picture, right is right, up is up, near is near") {
  for (const float elevation : {-90.0f, -20.0f, 0.0f, 45.0f, 90.0f}) {
    const Camera camera = place_camera(view(33, elevation), bounds, 1.5f);
    const glm::vec3 centre = projected(camera, bounds.centre);
    CHECK(std::abs(centre.x) < 1e-5f);
    CHECK(std::abs(centre.y) < 1e-5f);
    CHECK(projected(camera, bounds.centre + camera.right).x > 0.01f);
    CHECK(projected(camera, bounds.centre + camera.up).y > 0.01f);
    CHECK(projected(camera, bounds.centre + camera.backward).z < centre.z);
    CHECK(glm::dot(glm::cross(camera.right, camera.up), camera.backward) == doctest::Approx(1));
  }
}

TEST_CASE("without a distance the whole sphere is seen and nearly fills the narrower side") {
  for (const float aspect : {0.5f, 1.0f, 2.0f}) {
    const Camera camera = place_camera(view(20, 30, UpAxis::y, std::nullopt), bounds, aspect);
    float widest = 0;
    for (int i = 0; i < 3600; ++i) {
      // The silhouette: directions as far from the axis as the tangent cone is.
      const float turn = static_cast<float>(i) * 0.0017453293f;
      const float back = bounds.radius / glm::distance(camera.eye, bounds.centre);
      const float out = std::sqrt(1 - back * back);
      const glm::vec3 direction =
          back * camera.backward + out * (std::cos(turn) * camera.right + std::sin(turn) * camera.up);
      const glm::vec3 seen = projected(camera, bounds.centre + bounds.radius * direction);
      widest = std::max({widest, std::abs(seen.x), std::abs(seen.y)});
      CHECK(seen.z > 0);
      CHECK(seen.z < 1);
    }
    CHECK(widest < 1.0f);
    CHECK(widest > 0.95f);
  }
}

TEST_CASE("the default key light shines from behind the object, the second from the side, a little from everywhere") {
  for (const float azimuth : {0.0f, 75.0f, 200.0f}) {
    const auto lights = default_lights(view(azimuth, 10));
    const Camera camera = place_camera(view(azimuth, 10), bounds, 1);
    REQUIRE(lights.size() == 3);
    CHECK(glm::dot(lights[0].direction, camera.backward) > 0.5f);
    CHECK(std::abs(glm::dot(lights[1].direction, camera.right)) > 0.8f);
    CHECK(lights[2].kind == LightKind::ambient);
    CHECK(lights[0].power.x > lights[1].power.x);
    CHECK(lights[1].power.x > lights[2].power.x);
  }
}
