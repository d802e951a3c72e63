// Where the camera stands and what it sees.
#include "engine/render/display/camera.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "engine/base/error.h"
#include "engine/render/light/default_lights.h"

using namespace quadgraph;

namespace {

const Sphere bounds{{1, 2, 3}, 10};

View view(float azimuth, float elevation, UpAxis up = UpAxis::y, std::optional<float> distance = 50.0f) {
  return {.azimuth = azimuth, .elevation = elevation, .distance = distance, .up = up};
}

glm::vec3 projected(const Camera& camera, const glm::vec3& point) {
  const glm::vec4 clip = camera.clip(point);
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
    CHECK(projected(camera, bounds.centre + camera.backward).z > centre.z);
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
      const float back = bounds.radius / glm::distance(glm::vec3(camera.eye), bounds.centre);
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

TEST_CASE("an orthographic picture shows as many mm as it says, at any distance, all of the object, nearest first") {
  for (const float distance : {0.1f, 50.0f, 1e6f}) {
    View ahead = view(33, 20, UpAxis::y, distance);
    ahead.orthographic = 8;
    const Camera camera = place_camera(ahead, bounds, 1.5f);
    const glm::vec3 beside = bounds.centre + 3.0f * camera.right - 2.0f * camera.up;
    for (const float depth : {-10.0f, 0.0f, 10.0f}) {
      const glm::vec3 seen = projected(camera, beside + depth * camera.backward);
      CHECK(seen.x == doctest::Approx(3 / (1.5 * 4)));
      CHECK(seen.y == doctest::Approx(-2 / 4.0));
      CHECK(seen.z == doctest::Approx(0.5 + 0.5 * depth / 10.1));
    }
    const ViewRay ray = view_ray(camera, {0.5f, -0.5f});
    CHECK(glm::dot(ray.along, glm::dvec3(camera.backward)) == doctest::Approx(-1));
    CHECK(glm::distance(glm::dvec3(beside), ray.through) < 1e-5);
  }
  View fit = view(33, 20, UpAxis::y, std::nullopt);
  fit.orthographic = 0;
  for (const float aspect : {0.5f, 1.0f, 2.0f}) {
    const Camera camera = place_camera(fit, bounds, aspect);
    CHECK(std::min(camera.half_width, camera.half_height) == doctest::Approx(1.02 * bounds.radius));
  }
}

TEST_CASE("a camera that is moved sees along its rays, and what is in focus where it was") {
  View places[] = {view(33, 20), view(-70, -40, UpAxis::z), view(33, 20)};
  places[2].orthographic = 8;
  for (const View& from : places) {
    const Camera camera = place_camera(from, bounds, 1.5f);
    const double focus = camera.parallel ? 1 : 44;
    const glm::dvec2 shift(0.02, -0.03), lens = camera.parallel ? glm::dvec2(0) : glm::dvec2(1.2, -0.7);
    const Camera there = moved(camera, shift, lens, focus);
    const glm::vec3 sharp =
        glm::vec3(camera.eye - focus * glm::dvec3(camera.backward)) + 2.0f * camera.right + camera.up;
    const glm::vec3 before = projected(camera, sharp), after = projected(there, sharp);
    CHECK(after.x - before.x == doctest::Approx(shift.x).epsilon(1e-3));
    CHECK(after.y - before.y == doctest::Approx(shift.y).epsilon(1e-3));
    for (const glm::vec2& at : {glm::vec2(0), glm::vec2(0.7f, -0.4f), glm::vec2(-1, 1)}) {
      const glm::vec3 across = at.x * static_cast<float>(camera.half_width) * camera.right +
                               at.y * static_cast<float>(camera.half_height) * camera.up;
      const glm::vec3 ray =
          there.ahead + (camera.parallel ? glm::vec3(0) : across / static_cast<float>(camera.distance));
      for (const float further : {-5.0f, 0.0f, 30.0f}) {
        const glm::vec3 seen = projected(there, glm::vec3(there.target) + across + further * ray);
        CHECK(seen.x == doctest::Approx(at.x).epsilon(1e-4).scale(1));
        CHECK(seen.y == doctest::Approx(at.y).epsilon(1e-4).scale(1));
      }
    }
  }
}

TEST_CASE("a view by places is one by angles") {
  for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
    const View places{.up = up, .eye = glm::vec3(20, -5, 31), .look_at = glm::vec3(2, 4, -1)};
    const Camera camera = place_camera(places, bounds, 1.5f);
    CHECK(near(camera.eye, *places.eye));
    CHECK(near(projected(camera, *places.look_at) * glm::vec3(1, 1, 0), {0, 0, 0}));
    CHECK(glm::dot(camera.right, up == UpAxis::y ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1)) == doctest::Approx(0));
    const View angles = by_angles(places, bounds);
    CHECK(!angles.eye);
    const Camera same = place_camera(angles, bounds, 1.5f);
    CHECK(near(same.eye, camera.eye));
    CHECK(near(same.target, camera.target));
    CHECK(near(same.up, camera.up));
  }
  const View above{.azimuth = 90, .eye = glm::vec3(1, 30, 3), .look_at = glm::vec3(1, 2, 3)};
  CHECK(near(place_camera(above, bounds, 1).up, {-1, 0, 0}));
  CHECK_THROWS_WITH_AS(check_view({.eye = glm::vec3(1)}), "view: look_at is missing, eye and look_at go together",
                       InputError);
  CHECK_THROWS_WITH_AS(check_view({.eye = glm::vec3(1), .look_at = glm::vec3(1)}),
                       "view: eye and look_at are the same place", InputError);
  CHECK_THROWS_AS(check_view({.orthographic = -1.0f}), InputError);
}

TEST_CASE("a studio turns with the view, from wherever that is said") {
  CHECK(studio_of(view(0, 10)) == parse_light("studio"));
  CHECK(studio_of(view(40, 10)).turn == 40);
  const Light upright = studio_of({.azimuth = 40, .up = UpAxis::z});
  CHECK(upright.up == glm::vec3(0, 0, 1));
  const Camera from = place_camera(view(40, 10), bounds, 1);
  const Light placed = studio_of({.eye = bounds.centre + 50.0f * from.backward, .look_at = bounds.centre});
  CHECK(placed.turn == doctest::Approx(40));
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
