// Pictures that nobody gave a distance for hold the outline of the body, and nothing else decides.
#include "engine/render/display/framing.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <vector>

#include "engine/render/display/camera.h"

using namespace quadgraph;

namespace {

// A long thin bar that slants, off the origin.
Sphere bar() {
  std::vector<glm::vec3> points;
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 side(i & 1 ? 40 : -40, i & 2 ? 2 : -2, i & 4 ? 1 : -1);
    points.push_back(glm::vec3(7, -3, 11) +
                     glm::vec3(0.8f * side.x - 0.6f * side.y, 0.6f * side.x + 0.8f * side.y, side.z));
  }
  Sphere body = bounding_sphere(points);
  body.outline = std::make_shared<const std::vector<glm::vec3>>(points);
  return body;
}

// From -1 to 1 over the picture: the largest of where points lie, across and upward.
glm::vec2 farthest(const Camera& camera, const Sphere& body) {
  glm::vec2 most(0);
  for (const glm::vec3& point : *body.outline) {
    const glm::vec4 clip = camera.clip(point);
    CHECK(clip.z > 0);
    CHECK(clip.z < clip.w);
    most = glm::max(most, glm::abs(glm::vec2(clip) / clip.w));
  }
  return most;
}

template <typename Look>
void at_many_places(const Look& look) {
  for (const float aspect : {0.4f, 1.0f, 2.5f}) {
    for (const float elevation : {-90.0f, -20.0f, 0.0f, 35.0f, 90.0f}) {
      for (const float azimuth : {0.0f, 33.0f, 90.0f, 217.0f}) {
        for (const UpAxis up : {UpAxis::y, UpAxis::z})
          look(View{.azimuth = azimuth, .elevation = elevation, .up = up}, aspect);
      }
    }
  }
}

}  // namespace

TEST_CASE(
    "the outline of a long thin body touches the margin and never leaves the picture, in perspective and without") {
  const Sphere body = bar();
  at_many_places([&](View view, float aspect) {
    for (const bool parallel : {false, true}) {
      if (parallel) view.orthographic = 0.0f;
      const glm::vec2 most = farthest(place_camera(view, body, aspect), body);
      CHECK(std::max(most.x, most.y) == doctest::Approx(1 - outline_margin).epsilon(1e-3));
    }
  });
}

TEST_CASE("its outline lies in the middle: as far from one side as from the other") {
  const Sphere body = bar();
  at_many_places([&](View view, float aspect) {
    view.orthographic = 0.0f;
    const Camera camera = place_camera(view, body, aspect);
    glm::vec2 low(2), high(-2);
    for (const glm::vec3& point : *body.outline) {
      low = glm::min(low, glm::vec2(camera.clip(point)));
      high = glm::max(high, glm::vec2(camera.clip(point)));
    }
    CHECK(glm::length(low + high) < 1e-4f);
  });
}

TEST_CASE("a body that turns stays in the picture, which stays where it is") {
  const Sphere body = bar();
  for (const float elevation : {0.0f, 25.0f}) {
    float most = 0;
    double distance = 0;
    for (float azimuth = 0; azimuth < 360; azimuth += 1) {
      const View view{.azimuth = azimuth, .elevation = elevation, .framing = Framing::turned};
      const Camera camera = place_camera(view, body, 1);
      const glm::vec2 here = farthest(camera, body);
      most = std::max({most, here.x, here.y});
      if (azimuth == 0) distance = camera.distance;
      CHECK(camera.distance == doctest::Approx(distance).epsilon(0.01));
    }
    CHECK(most < 1);
    CHECK(most > 0.85f);
  }
}

TEST_CASE("a distance, places or a height that are said count as before") {
  const Sphere body = bar(), sphere{body.centre, body.radius};
  View views[] = {
      {.azimuth = 33, .distance = 200.0f}, {.azimuth = 33}, {.eye = glm::vec3(90, 80, 70), .look_at = glm::vec3(1)}};
  views[1].orthographic = 50.0f;
  for (const View& view : views) {
    CHECK(glm::distance(place_camera(view, body, 1.5f).eye, place_camera(view, sphere, 1.5f).eye) < 1e-9);
    CHECK(place_camera(view, body, 1.5f).half_height == place_camera(view, sphere, 1.5f).half_height);
  }
}

TEST_CASE("a body that is one point is shown, not divided by") {
  Sphere body = bounding_sphere(std::vector<glm::vec3>{{1, 2, 3}});
  body.outline = std::make_shared<const std::vector<glm::vec3>>(1, glm::vec3(1, 2, 3));
  CHECK(place_camera({}, body, 1).distance > 0);
}
