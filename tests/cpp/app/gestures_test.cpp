// What drags and keys do to camera and lights, without a window.
#include "engine/scene/gestures.h"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>
#include <memory>
#include <vector>

#include "engine/app/commands.h"
#include "engine/app/pace.h"

using namespace quadgraph;

namespace {

const Sphere bounds{{10, 20, 30}, 40};

// Where a point is seen, in clip coordinates: right and up.
glm::vec2 seen(const View& view, const glm::vec3& point) {
  const glm::vec4 clip = place_camera(view, bounds, 1).clip(point);
  return {clip.x / clip.w, clip.y / clip.w};
}

const glm::vec3 eye(60, 50, 90), look_at(12, 18, 25);

// In perspective and with parallel rays, by angles and by places.
std::vector<View> views() {
  return {{.azimuth = 30, .elevation = 20},
          {.azimuth = 30, .elevation = 20, .up = UpAxis::z},
          {.azimuth = 30, .elevation = 20, .orthographic = 90.0f},
          {.eye = eye, .look_at = look_at},
          {.up = UpAxis::z, .orthographic = 0.0f, .eye = eye, .look_at = look_at}};
}

}  // namespace

TEST_CASE("what is dragged follows the hand") {
  for (const View& view : views()) {
    const glm::vec3 near = bounds.centre + 0.5f * bounds.radius * place_camera(view, bounds, 1).backward;
    CHECK(seen(orbited(view, bounds, 1, 10, 0), near).x > seen(view, near).x + 0.05f);
    CHECK(seen(orbited(view, bounds, 1, 0, 10), near).y > seen(view, near).y + 0.05f);
    const glm::vec3 middle = place_camera(view, bounds, 1).target;
    const glm::vec2 moved = seen(panned(view, bounds, 1, 0.25f, -0.1f), middle);
    CHECK(moved.x == doctest::Approx(0.5).epsilon(1e-3));
    CHECK(moved.y == doctest::Approx(-0.2).epsilon(1e-3));
    const glm::vec3 beside = middle + place_camera(view, bounds, 1).right;
    CHECK(seen(zoomed(view, bounds, 1, 1), beside).x == doctest::Approx(seen(view, beside).x / 0.875f).epsilon(1e-4));
    const Light light{.kind = LightKind::directional, .direction = -place_camera(view, bounds, 1).backward};
    const Light turned_light = turned(light, view, bounds, 15, 10);
    const Camera camera = place_camera(view, bounds, 1);
    CHECK(glm::dot(-turned_light.direction, camera.right) > 0.2f);
    CHECK(glm::dot(-turned_light.direction, camera.up) > 0.1f);
    CHECK(glm::length(turned_light.direction) == doctest::Approx(1));
  }
}

TEST_CASE("a cut goes through the stroke, and takes what lies to the right of the hand's way") {
  for (const auto& [view, to] : std::vector<std::pair<View, glm::vec2>>{{views()[0], {0.1f, 0.6f}},
                                                                        {views()[0], {-0.5f, -0.3f}},
                                                                        {views()[2], {-0.5f, -0.3f}},
                                                                        {views()[3], {0.1f, 0.6f}}}) {
    const glm::vec2 from(0.1f, -0.2f), way = glm::normalize(to - from), right(way.y, -way.x);
    const BodyCut cut = cut_along(view, bounds, 1, from, to);
    CHECK_NOTHROW(check_cut(cut));
    const Camera camera = place_camera(view, bounds, 1);
    for (const float depth : {-0.5f, 0.0f, 0.5f}) {
      for (const float across : {-0.6f, 0.1f, 0.7f}) {
        const glm::vec3 point = bounds.centre + bounds.radius * (depth * camera.backward + across * camera.right);
        const float beside = glm::dot(seen(view, point) - from, right);
        CHECK((glm::dot(cut.normal, point) > cut.offset) == (beside > 0));
      }
    }
  }
}

TEST_CASE("a view can be turned, moved and zoomed for ever and stays one that can be shown") {
  for (View view : views())
    for (int i = 0; i < 400; ++i) {
      view = orbited(view, bounds, 1.5f, 37, 23);
      view = panned(view, bounds, 1.5f, 0.3f, -0.2f);
      view = zoomed(view, bounds, 1.5f, i < 200 ? 1 : -1);
      CHECK_NOTHROW(place_camera(view, bounds, 1.5f));
      CHECK(std::abs(view.azimuth) <= 180);
    }
}

TEST_CASE("a light of another kind lights the object as strongly, and turns back into the same") {
  const Light sun{
      .kind = LightKind::directional, .direction = glm::normalize(glm::vec3(1, -2, 0.5f)), .power = {1, 0.5f, 0.25f}};
  for (const LightKind kind : {LightKind::point, LightKind::spot, LightKind::rectangle, LightKind::projector}) {
    Light other = as_kind(sun, kind, bounds);
    if (kind == LightKind::projector) other.file = "stripes.png";
    CHECK_NOTHROW(check_light(other));
    const glm::vec3 away = bounds.centre - other.position;
    CHECK(glm::distance(glm::normalize(away), sun.direction) < 1e-5f);
    const float squared = glm::dot(away, away);
    if (kind == LightKind::point) CHECK(other.power.x / (4 * 3.14159265f * squared) == doctest::Approx(1));
    if (kind == LightKind::spot) CHECK(axis_intensity(other).x / squared == doctest::Approx(1));
    if (kind == LightKind::rectangle) CHECK(glm::dot(glm::cross(other.u, other.v), away) > 0);
    const Light back = as_kind(other, LightKind::directional, bounds);
    CHECK(glm::distance(back.power, sun.power) < 1e-5f);
    CHECK(glm::distance(back.direction, sun.direction) < 1e-5f);
  }
}

TEST_CASE("a light that becomes an environment and back brings as much light to a plane that faces it") {
  const Sphere bounds{{1, 2, 3}, 10};
  const Light sun{.kind = LightKind::directional, .direction = {0, -1, 0}, .power = {1, 0.5f, 0.25f}};
  const Light around = as_kind(sun, LightKind::environment, bounds);
  CHECK(around.power.x == doctest::Approx(1 / 3.14159265));
  const Light back = as_kind(around, LightKind::directional, bounds);
  CHECK(glm::distance(back.power, sun.power) < 1e-6f);
}

TEST_CASE("a rectangle faces where it is told to, upright, as large as it was") {
  const Light light{.kind = LightKind::rectangle, .u = {3, 1, 0}, .v = {-1, 3, 2}};
  for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
    const glm::vec3 direction = glm::normalize(glm::vec3(1, -2, 3));
    const Light aimed = faced(light, direction, up);
    CHECK(glm::distance(glm::normalize(glm::cross(aimed.u, aimed.v)), direction) < 1e-6f);
    CHECK(glm::length(aimed.u) == doctest::Approx(glm::length(light.u)));
    CHECK(glm::length(aimed.v) == doctest::Approx(glm::length(light.v)));
    CHECK(std::abs(up == UpAxis::y ? aimed.u.y : aimed.u.z) < 1e-6f);
  }
}

TEST_CASE("a light that is turned about the body faces it as before") {
  const Sphere bounds{{1, 2, 3}, 10};
  const Light sun{.kind = LightKind::directional, .direction = {0, 0, -1}, .power = {1, 1, 1}};
  for (const LightKind kind : {LightKind::rectangle, LightKind::projector}) {
    const Light light = as_kind(sun, kind, bounds), moved = turned(light, {}, bounds, 50, 20);
    CHECK(glm::distance(moved.position, light.position) > 5);
    const glm::vec3 away = glm::normalize(bounds.centre - moved.position);
    CHECK(glm::distance(glm::normalize(glm::cross(moved.u, moved.v)), away) < 1e-5f);
    CHECK(glm::distance(moved.direction, away) < 1e-5f);
    if (kind == LightKind::projector) CHECK(std::abs(glm::dot(moved.up, moved.direction)) < 1e-5f);
  }
}

TEST_CASE("bearings of lights read back") {
  for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
    const Bearing bearing = bearing_of(towards({.azimuth = -120, .elevation = 35}, up), up);
    CHECK(bearing.azimuth == doctest::Approx(-120));
    CHECK(bearing.elevation == doctest::Approx(35));
  }
}

TEST_CASE("every key does something, and no two share one") {
  const auto commands = all_commands();
  for (std::size_t i = 0; i < commands.size(); ++i) {
    CHECK_FALSE(commands[i].text.empty());
    for (std::size_t k = 0; k < i; ++k) {
      const bool shares = commands[i].key == commands[k].key || commands[i].key == commands[k].other_key ||
                          (commands[i].other_key != 0 && (commands[i].other_key == commands[k].key ||
                                                          commands[i].other_key == commands[k].other_key));
      CHECK_FALSE((shares && commands[i].mods == commands[k].mods));
    }
    State state;
    state.scene.lights = {Light{.kind = LightKind::directional, .power = glm::vec3(1)}, Light{}};
    // What the keys change must not be at the end of its range already.
    state.scene.view.distance = 200.0f;
    state.scene.view.azimuth = 5;
    const State before = state;
    CHECK(run_command(commands[i].key, commands[i].mods, state, {bounds, 1.5f, 4}));
    const bool wished = state.quit || state.full_screen || state.undo || state.redo || state.save || state.screenshot ||
                        state.save_film || state.focus_panel || state.help != before.help ||
                        state.panel != before.panel || state.light != before.light ||
                        state.brush.on != before.brush.on || state.knife.on != before.knife.on || state.turntable ||
                        state.compares();
    CHECK_MESSAGE((wished || state.scene != before.scene), commands[i].keys);
  }
  State state;
  CHECK_FALSE(run_command(-1, 0, state, {bounds, 1, 1}));
}

TEST_CASE("a picture in motion keeps to its budget, and takes all of it") {
  Pace pace(400);
  CHECK(pace.share(1e6, true) == 1);
  const auto take = [&](double solve_ms, double draw_ms, bool gathered) {
    pace.solved(solve_ms, false);
    pace.drawn(draw_ms, 1e6, gathered);
  };
  for (int i = 0; i < 20; ++i) take(250, 600, true);
  CHECK(pace.share(1e6, false) == 0.75f);  // 340 of 400 ms
  CHECK(pace.share(1e6, true) == 0.5f);    // 150 of the 150 that the solve leaves
  CHECK(pace.share(1e4, true) == 1);
  CHECK(pace.gathers(true));
  for (int i = 0; i < 20; ++i) take(800, 100, false);
  CHECK_FALSE(pace.gathers(true));  // the solve has taken all of it
  CHECK(pace.gathers(false));
  CHECK(pace.share(1e6, true) == 1);
}

TEST_CASE("a picture in motion is corrected where that keeps to its budget") {
  Pace pace(100);
  CHECK_FALSE(pace.corrects());  // nothing is known
  pace.solved(30, false);
  CHECK_FALSE(pace.corrects());  // it takes some times as long
  Pace quick(100);
  quick.solved(20, false);
  CHECK(quick.corrects());
  quick.solved(150, true);
  CHECK_FALSE(quick.corrects());  // as measured
  for (int i = 0; i < 5; ++i) quick.solved(80, true);
  CHECK(quick.corrects());
}

TEST_CASE("a hand that begins to move the view finds it where it is") {
  Sphere box = bounds;
  box.outline = std::make_shared<const std::vector<glm::vec3>>(
      std::vector{bounds.centre + glm::vec3(9, 1, 0), bounds.centre - glm::vec3(9, 2, 1)});
  for (const bool parallel : {false, true}) {
    View view{.azimuth = 33, .target = {1, 2, 3}};
    if (parallel) view.orthographic = 0.0f;
    const Camera before = place_camera(view, box, 1.5f);
    const View moved[] = {framed(view, box, 1.5f), orbited(view, box, 1.5f, 0, 0), panned(view, box, 1.5f, 0, 0),
                          zoomed(view, box, 1.5f, 0)};
    for (const View& after : moved) {
      const Camera there = place_camera(after, box, 1.5f);
      for (const glm::vec3& point : *box.outline) {
        const glm::vec4 a = before.clip(point), b = there.clip(point);
        CHECK(glm::distance(glm::vec2(a) / a.w, glm::vec2(b) / b.w) < 1e-3f);
      }
    }
  }
}
