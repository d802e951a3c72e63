// The light that enters: energy, shadows, and visibility against rays traced on the CPU.
#include "engine/render/light/irradiance.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

#include "engine/base/error.h"
#include "engine/device/commands.h"
#include "engine/optics/fresnel.h"
#include "engine/optics/surface_boundary.h"
#include "tests/cpp/fixtures/checked_context.h"
#include "tests/cpp/fixtures/one_body.h"
#include "tests/cpp/fixtures/render_shapes.h"

using namespace quadgraph;

namespace {

constexpr float pi = std::numbers::pi_v<float>;

void run_irradiance(device::Device& context, const LevelBuffers& level, std::uint32_t number, const ShadowMaps& shadows,
                    bool rough = false) {
  IrradiancePass pass(context);
  device::Commands commands(context, 1);
  pass.record(commands, level, number, shadows, 0, rough);
  commands.submit_and_wait();
}

std::vector<glm::vec3> irradiance(device::Device& context, const Shape& shape, const std::vector<Light>& lights,
                                  float eta) {
  const DisplayBuffers mesh = upload_as_display(context, shape);
  const OneBody refractions(context, eta);
  const LevelBuffers level = upload_as_level(context, shape, lights.size(), refractions);
  ShadowMaps shadows(context);
  shadows.update(mesh, {lights, bounding_sphere(shape.vertices)});
  run_irradiance(context, level, 0, shadows);
  return device::download<glm::vec3>(context, level.q);
}

// Power that enters, W.
glm::dvec3 entered(const Shape& shape, const std::vector<glm::vec3>& q) {
  glm::dvec3 sum(0);
  for (std::size_t f = 0; f < q.size(); ++f) sum += 0.5 * glm::length(face_normal(shape, f)) * glm::dvec3(q[f]);
  return sum;
}

// Moeller and Trumbore 1997.
bool hits(const Shape& shape, std::size_t f, const glm::vec3& origin, const glm::vec3& direction, float least) {
  const glm::uvec3& t = shape.faces[f];
  const glm::vec3& a = shape.vertices[t.x];
  const glm::vec3 ab = shape.vertices[t.y] - a, ac = shape.vertices[t.z] - a;
  const glm::vec3 p = glm::cross(direction, ac);
  const float det = glm::dot(ab, p);
  if (det == 0) return false;
  const glm::vec3 s = (origin - a) / det;
  const float u = glm::dot(s, p);
  const glm::vec3 r = glm::cross(s, ab);
  const float v = glm::dot(direction, r);
  return u >= 0 && v >= 0 && u + v <= 1 && glm::dot(ac, r) > least;
}

// Share of a face's samples (those of irradiance.comp) that see a light in `direction`.
float traced_visibility(const Shape& shape, std::size_t face, const glm::vec3& direction) {
  const glm::uvec3& t = shape.faces[face];
  const glm::vec3& a = shape.vertices[t.x];
  const glm::vec3 ab = shape.vertices[t.y] - a, ac = shape.vertices[t.z] - a;
  int seen = 0, samples = 0;
  constexpr int n = 4;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      for (int inverted = 0; inverted < (i + j + 1 < n ? 2 : 1); ++inverted) {
        const float in = inverted == 1 ? 2.0f / 3.0f : 1.0f / 3.0f;
        const glm::vec3 origin = a + (static_cast<float>(i) + in) / n * ab + (static_cast<float>(j) + in) / n * ac;
        bool blocked = false;
        for (std::size_t f = 0; f < shape.faces.size() && !blocked; ++f) {
          blocked = f != face && hits(shape, f, origin, direction, 1e-3f);
        }
        seen += blocked ? 0 : 1;
        ++samples;
      }
    }
  }
  return static_cast<float>(seen) / static_cast<float>(samples);
}

}  // namespace

TEST_CASE("a sphere takes in the light of its cross-section") {
  CheckedContext checked;
  device::Device& context = checked.context;
  constexpr float radius = 10;
  const Shape shape = sphere({3, -2, 5}, radius, 5);
  double worst = 0;
  for (const char* light : {"directional:0,0,-1:2", "directional:1,2,3:2", "directional:-0.3,-1,0.2:2"}) {
    const auto q = irradiance(context, shape, {parse_light(light)}, 1.0f);
    worst = std::max(worst, std::abs(entered(shape, q).x / (pi * radius * radius * 2) - 1));
  }
  INFO("worst relative error ", worst);
  // The polyhedron's own cross-section is smaller by less than (edge / radius)^2 / 8 = 0.0003.
  CHECK(worst < 1e-3);
}

TEST_CASE("a distant point light, near and in all six directions, gives its share of the solid angle") {
  CheckedContext checked;
  device::Device& context = checked.context;
  constexpr float radius = 10, power = 7;
  const Shape shape = sphere({0, 0, 0}, radius, 5);
  // 30: one frustum; 10.5, inside 1.1 radii: six faces. Half the flux within the cone that touches the sphere.
  for (const float distance : {30.0f, 10.5f}) {
    const float share = 0.5f * (1 - std::sqrt(1 - radius * radius / (distance * distance)));
    for (const glm::vec3& axis : {glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(0.6f, 0, -0.8f)}) {
      const Light light{.kind = LightKind::point, .position = distance * axis, .power = glm::vec3(power)};
      const auto q = irradiance(context, shape, {light}, 1.0f);
      CAPTURE(distance);
      CHECK(entered(shape, q).x / (power * share) == doctest::Approx(1).epsilon(0.004));
    }
  }
}

TEST_CASE("q follows the cosine and the exact Fresnel transmittance, and lights add up") {
  CheckedContext checked;
  device::Device& context = checked.context;
  const Shape shape = sphere({0, 0, 0}, 10, 3);
  const auto red = parse_light("directional:0,0,-1:1/0/0"), blue = parse_light("directional:0,-1,0:0/0/3");
  const auto q = irradiance(context, shape, {red, blue}, 1.5f);
  const auto expected = [](float cos_i, float power) {
    return cos_i <= 0 ? 0.0 : cos_i * power * fresnel_transmittance(cos_i, 1.5);
  };
  for (std::size_t f = 0; f < q.size(); ++f) {
    const glm::vec3 n = glm::normalize(face_normal(shape, f));
    // Within a face's width of the terminator a face may lie in the shadow of the silhouette's.
    if (std::abs(n.z) > 0.1f) CHECK(q[f].r == doctest::Approx(expected(n.z, 1)).epsilon(1e-4));
    if (std::abs(n.y) > 0.1f) CHECK(q[f].b == doctest::Approx(expected(n.y, 3)).epsilon(1e-4));
    CHECK(q[f].g == 0);
  }
}

TEST_CASE("shadow maps of many lights are halved until they share their memory") {
  const Sphere bounds{{0, 0, 0}, 10};
  const auto sides = [&](const char* text, std::size_t count) {
    const LightSet set(std::vector<Light>(count, parse_light(text)), bounds);
    CHECK(set.map_bytes() <= most_map_bytes);
    CHECK(set.records.size() >= count);
    return set.views.front().size;
  };
  CHECK(sides("directional:0,0,-1:1", 1) == gpu::SHADOW_SIZE);
  CHECK(sides("directional:0,0,-1:1", 32) == gpu::SHADOW_SIZE);
  CHECK(sides("directional:0,0,-1:1", 33) == gpu::SHADOW_SIZE / 2);
  CHECK(sides("point:0,0,10:1", 21) == gpu::SHADOW_CUBE_SIZE);
  CHECK(sides("point:0,0,10:1", most_lights) == gpu::SHADOW_CUBE_SIZE / 8);
  CHECK(sides("rectangle:0,0,10:1,0,0:0,1,0:1", most_lights) == gpu::SHADOW_PATCH_CUBE_SIZE / 16);
}

TEST_CASE("many lights bring what one brings, within the memory of their maps") {
  CheckedContext checked;
  const Shape shape = sphere({0, 0, 0}, 10, 4);
  const DisplayBuffers mesh = upload_as_display(checked.context, shape);
  const auto with = [&](std::size_t count) {
    const Light light{.direction = glm::normalize(glm::vec3(1, 2, 3)), .power = glm::vec3(1.0f / count)};
    const std::vector<Light> lights(count, light);
    const OneBody refractions(checked.context, 1);
    const LevelBuffers level = upload_as_level(checked.context, shape, count, refractions);
    ShadowMaps shadows(checked.context);
    shadows.update(mesh, {lights, bounding_sphere(shape.vertices)});
    CHECK(checked.context.allocated_by_purpose().at("shadows") < most_map_bytes + (64u << 20));
    run_irradiance(checked.context, level, 0, shadows);
    return entered(shape, device::download<glm::vec3>(checked.context, level.q)).x;
  };
  CHECK(with(150) == doctest::Approx(with(1)).epsilon(1e-3));
}

TEST_CASE("a shadow map is drawn again only where its view or the mesh has changed, and all are as if drawn anew") {
  CheckedContext checked;
  device::Device& context = checked.context;
  Shape shape = sphere({0, 0, 0}, 5, 2), moved = shape;
  shape.append(sphere({0, 0, 9}, 3, 2));
  moved.append(sphere({4, 0, 9}, 3, 2));
  DisplayBuffers mesh = upload_as_display(context, shape);
  const auto sun = [](float x) {
    return Light{.direction = glm::normalize(glm::vec3(x, 0, -1)), .power = glm::vec3(1)};
  };
  const Light lamp = parse_light("point:0,0,30:1000"), inner = parse_light("point:0,0,7:1000");  // six views
  ShadowMaps shadows(context);
  const auto check = [&](const std::vector<Light>& lights, const Shape& present, std::uint32_t drawn) {
    const LightSet set(lights, bounding_sphere(present.vertices));
    CHECK(shadows.update(mesh, set).count == drawn);
    const OneBody refractions(context, 1);
    const LevelBuffers level = upload_as_level(context, present, lights.size(), refractions);
    run_irradiance(context, level, 0, shadows);
    CHECK(device::download<glm::vec3>(context, level.q) == irradiance(context, present, lights, 1.0f));
  };
  check({sun(0), lamp}, shape, 2);
  check({sun(0), lamp}, shape, 0);
  check({sun(0.5f), lamp}, shape, 1);
  check({lamp, sun(0.5f)}, shape, 2);
  check({lamp, inner}, shape, 6);
  check({lamp}, shape, 0);
  check({lamp, sun(0.5f), inner}, shape, 7);
  mesh = upload_as_display(context, moved);
  shadows.forget();
  check({lamp, sun(0.5f), inner}, moved, 8);
}

TEST_CASE("in motion coarser levels are sampled as the finest is, and many faces by a sample a quarter") {
  CheckedContext checked;
  device::Device& context = checked.context;
  const std::vector<Light> sun = {Light{.direction = glm::normalize(glm::vec3(1, 2, 3)), .power = glm::vec3(1)}};
  const auto q_of = [&](const Shape& shape, std::uint32_t number, bool rough) {
    const OneBody refractions(context, 1.3f);
    const LevelBuffers level = upload_as_level(context, shape, 1, refractions);
    ShadowMaps shadows(context);
    shadows.update(upload_as_display(context, shape), {sun, bounding_sphere(shape.vertices)});
    run_irradiance(context, level, number, shadows, rough);
    return device::download<glm::vec3>(context, level.q);
  };
  Shape few = sphere({0, 0, 0}, 10, 3), many = sphere({0, 0, 0}, 10, 6);
  for (Shape* shape : {&few, &many}) shape->append(sphere({-5, -10, -15}, 3, 3));  // in the way of some light
  CHECK(q_of(few, 1, true) == q_of(few, 0, false));
  CHECK(q_of(few, 1, true) != q_of(few, 1, false));
  const auto rough = q_of(many, 0, true), fine = q_of(many, 0, false);
  CHECK(rough != fine);
  CHECK(entered(many, rough).x == doctest::Approx(entered(many, fine).x).epsilon(1e-3));
}

TEST_CASE("more lights than a scene may have are refused") {
  CHECK_NOTHROW(check_light_count(most_lights));
  CHECK_THROWS_WITH_AS(check_light_count(3000),
                       "lights: found 3000, allowed are at most 1024; leave some out, or show many in the image of an "
                       "environment",
                       InputError);
}

TEST_CASE("every light has its own quarters, which make up q") {
  CheckedContext checked;
  device::Device& context = checked.context;
  const Shape shape = sphere({0, 0, 0}, 10, 1);
  const std::vector<Light> lights = {parse_light("point:0,0,14:5000/100/0"), parse_light("directional:0,-1,0:0/1/3")};
  const OneBody refractions(context, 1);
  const LevelBuffers level = upload_as_level(context, shape, lights.size(), refractions);
  ShadowMaps shadows(context);
  shadows.update(upload_as_display(context, shape), {lights, bounding_sphere(shape.vertices)});
  run_irradiance(context, level, 0, shadows);
  const auto q = device::download<glm::vec3>(context, level.q);
  const auto shares = device::download<float>(context, level.beam_q);
  REQUIRE(shares.size() == lights.size() * FACE_QUARTERS * shape.faces.size());
  const auto brought = [&](std::size_t light, std::size_t f, std::size_t k) {
    return shares[(light * shape.faces.size() + f) * FACE_QUARTERS + k] * light_record(lights[light]).power;
  };
  std::size_t lit = 0;
  for (std::size_t f = 0; f < shape.faces.size(); ++f) {
    glm::vec3 sum(0);
    for (std::size_t light = 0; light < lights.size(); ++light) {
      for (std::size_t k = 0; k < FACE_QUARTERS; ++k) {
        sum += brought(light, f, k);
      }
    }
    for (int c = 0; c < 3; ++c) CHECK(sum[c] / FACE_QUARTERS == doctest::Approx(q[f][c]).epsilon(1e-6));
    // The point light falls off over the face: the mean over a quarter of its four parts' centroids.
    const glm::vec3 n = glm::normalize(face_normal(shape, f));
    std::array<glm::vec3, 3> corner;
    for (int k = 0; k < 3; ++k) corner[static_cast<std::size_t>(k)] = shape.vertices[shape.faces[f][k]];
    const glm::vec3 centre = (corner[0] + corner[1] + corner[2]) / 3.0f;
    if (glm::dot(glm::normalize(glm::vec3(0, 0, 14) - centre), n) < 0.5f) continue;
    ++lit;
    const auto middle = [](const std::array<glm::vec3, 3>& t, std::size_t k) {
      return std::array<glm::vec3, 3>{t[k], (t[k] + t[(k + 1) % 3]) / 2.0f, (t[k] + t[(k + 2) % 3]) / 2.0f};
    };
    const auto inner = [](const std::array<glm::vec3, 3>& t) {
      return std::array<glm::vec3, 3>{(t[0] + t[1]) / 2.0f, (t[1] + t[2]) / 2.0f, (t[2] + t[0]) / 2.0f};
    };
    for (std::size_t k = 0; k < FACE_QUARTERS; ++k) {
      const auto quarter = k < 3 ? middle(corner, k) : inner(corner);
      double expected = 0;
      for (std::size_t part = 0; part < 4; ++part) {
        const auto t = part < 3 ? middle(quarter, part) : inner(quarter);
        const glm::vec3 to_light = glm::vec3(0, 0, 14) - (t[0] + t[1] + t[2]) / 3.0f;
        const double d = glm::length(to_light);
        expected += 5000 / (4 * pi) * glm::dot(n, to_light) / (d * d * d) / 4;
      }
      CHECK(brought(0, f, k).r == doctest::Approx(expected).epsilon(1e-4));
    }
  }
  CHECK(lit > 0);
}

TEST_CASE("without lights no light enters") {
  CheckedContext checked;
  device::Device& context = checked.context;
  for (const glm::vec3& q : irradiance(context, sphere({0, 0, 0}, 1, 2), {}, 1.3f)) CHECK(q == glm::vec3(0));
}

TEST_CASE("a sphere shadows another as traced rays say, also through a thin plate") {
  CheckedContext checked;
  device::Device& context = checked.context;
  Shape shape = sphere({0, 0, 0}, 10, 4);
  shape.append(sphere({6, 18, 3}, 6, 4));
  // A plate of 0.1 mm, about three texels of the map.
  Shape plate = sphere({-7, 14, -4}, 5, 3);
  for (glm::vec3& v : plate.vertices) v.y = 14 + 0.01f * (v.y - 14);
  shape.append(plate);

  const glm::vec3 travel = glm::normalize(glm::vec3(0.2f, -1, 0.1f));
  const auto q = irradiance(context, shape, {{.direction = travel, .power = glm::vec3(1)}}, 1.0f);
  std::vector<float> errors;
  double traced_power = 0;
  std::size_t dark = 0;
  for (std::size_t f = 0; f < q.size(); ++f) {
    const glm::vec3 normal = face_normal(shape, f);
    const float cos_i = -glm::dot(travel, glm::normalize(normal));
    if (cos_i <= 0.02f) continue;
    const float truth = traced_visibility(shape, f, -travel);
    errors.push_back(std::abs(q[f].x / cos_i - truth));
    traced_power += 0.5 * glm::length(normal) * cos_i * truth;
    if (truth == 0) ++dark;
  }
  std::sort(errors.begin(), errors.end());
  double mean = 0;
  for (const float e : errors) mean += e / static_cast<double>(errors.size());
  MESSAGE("visibility against rays: median error ", errors[errors.size() / 2], ", mean ", mean, ", 99th percentile ",
          errors[errors.size() * 99 / 100], ", worst ", errors.back(), ", faces ", errors.size(), ", dark ", dark);
  MESSAGE("power / traced ", entered(shape, q).x / traced_power);
  CHECK(dark > errors.size() / 20);
  CHECK(errors[errors.size() / 2] < 1e-3f);
  CHECK(mean < 5e-3);
  CHECK(entered(shape, q).x == doctest::Approx(traced_power).epsilon(5e-3));
}

TEST_CASE("ambient light comes from the share of the sky that a face sees") {
  CheckedContext checked;
  device::Device& context = checked.context;
  const Shape shape = sphere(glm::vec3(0), 5.0f, 2);
  const DisplayBuffers mesh = upload_as_display(context, shape);
  Light ambient;
  ambient.kind = LightKind::ambient;
  ambient.power = {1, 2, 3};
  const OneBody refractions(context, 1.3f);
  LevelBuffers level = upload_as_level(context, shape, 1, refractions);
  std::vector<float> sky;
  for (std::size_t f = 0; f < shape.faces.size(); ++f) sky.push_back(static_cast<float>(f % 5) / 4.0f);
  level.sky = device::upload<float>(context, sky, "sky");
  ShadowMaps shadows(context);
  shadows.update(mesh, {{&ambient, 1}, bounding_sphere(shape.vertices)});
  run_irradiance(context, level, 0, shadows);
  const auto q = device::download<glm::vec3>(context, level.q);
  const auto entering = static_cast<float>(diffuse_transmittance(1.3));
  for (std::size_t f = 0; f < q.size(); ++f) {
    for (int c = 0; c < 3; ++c) CHECK(q[f][c] == doctest::Approx(entering * sky[f] * static_cast<float>(c + 1)));
  }
}
