// Edits of a material, and the depth they may depend on.
#include "engine/optics/edit.h"

#include <doctest/doctest.h>

#include <cmath>
#include <glm/common.hpp>
#include <random>

#include "engine/base/error.h"
#include "engine/optics/depth.h"
#include "tests/cpp/fixtures/test_graphs.h"

using namespace quadgraph;

namespace {

const gpu::Optical base{{1, 2, 3}, {0.1f, 0.2f, 0.3f}};

gpu::Optical after(std::initializer_list<Edit> edits, const glm::vec3& place = {}, float depth = 0) {
  const std::vector<Edit> all(edits);
  return EditArrays(all).apply(base, place, depth, 1);
}

}  // namespace

TEST_CASE("an edit everywhere multiplies, adds or sets what it names, in order") {
  using enum EditOperation;
  CHECK(after({}).sigma_a == base.sigma_a);
  CHECK(after({{.operation = multiply, .sigma_a = glm::vec3(2)}}).sigma_a == 2.0f * base.sigma_a);
  CHECK(after({{.operation = multiply, .sigma_a = glm::vec3(2)}}).sigma_s_prime == base.sigma_s_prime);
  CHECK(after({{.operation = add, .sigma_s_prime = glm::vec3(-2, 1, 0)}}).sigma_s_prime == glm::vec3(0, 3, 3));
  CHECK(after({{.operation = set, .sigma_a = glm::vec3(5)}}).sigma_a == glm::vec3(5));
  const Edit doubled{.operation = multiply, .sigma_a = glm::vec3(2)}, more{.operation = add, .sigma_a = glm::vec3(1)};
  CHECK(after({doubled, more}).sigma_a.x == doctest::Approx(1.2f));
  CHECK(after({more, doubled}).sigma_a.x == doctest::Approx(2.2f));
}

TEST_CASE("a stroke reaches as far as its radius, fading over its softness, between its depths") {
  Edit edit{.operation = Edit::Operation::set,
            .sigma_a = glm::vec3(1),
            .stroke = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}},
            .radius = 2,
            .depth_from = 1,
            .depth_to = 3,
            .softness = 0.5f};
  const auto amount = [&](const glm::vec3& place, float depth) {
    return (after({edit}, place, depth).sigma_a.x - base.sigma_a.x) / (1 - base.sigma_a.x);
  };
  CHECK(amount({5, 0, 0}, 2) == 1);
  CHECK(amount({5, 1.7f, 0}, 2) == 1);
  CHECK(amount({5, 2, 0}, 2) == doctest::Approx(0.5));
  CHECK(amount({5, 2.3f, 0}, 2) == 0);
  CHECK(amount({-1.7f, 0, 0}, 2) == 1);
  CHECK(amount({10, 5, 1.9f}, 2) > 0.5);
  CHECK(amount({5, 5, 0}, 2) == 0);
  CHECK(amount({5, 0, 0}, 0) == 0);
  CHECK(amount({5, 0, 0}, 1) == doctest::Approx(0.5));
  CHECK(amount({5, 0, 0}, 3) == doctest::Approx(0.5));
  CHECK(amount({5, 0, 0}, 3.3f) == 0);
  edit.depth_from = 0;
  CHECK(amount({5, 0, 0}, 0) == 1);
  edit.softness = 0;
  CHECK(amount({5, 1.999f, 0}, 2.999f) == 1);
  CHECK(amount({5, 2.001f, 0}, 2) == 0);
}

namespace {

// 4 x 2 texels: above 0, 1/4, 1/2, 3/4 from left to right, in green only; below 1.
std::shared_ptr<const ImagePyramid> steps() {
  Image image{4, 2, std::vector<glm::vec3>(8, glm::vec3(1))};
  for (std::uint32_t i = 0; i < 4; ++i) image.texels[i] = {0, 0.25f * static_cast<float>(i), 0};
  return std::make_shared<const ImagePyramid>(pyramid_of(image, 1024));
}

// 8 x 4 mm, 2 mm deep, seen along -y from above, its top towards -z: x to the right.
const Placement flat{.centre = {10, 5, 0}, .direction = {0, -3, 0}, .up = {0, 1, -1}, .size = {8, 4, 2}};

}  // namespace

TEST_CASE("a placed image multiplies what the edit does, where its box lies, as it is seen along its direction") {
  Edit edit{.operation = Edit::Operation::set, .sigma_a = glm::vec3(8), .placement = flat, .image = steps()};
  const auto at = [&](const glm::vec3& place) {
    return EditArrays(std::span(&edit, 1)).apply(base, place, 0, 0.1f).sigma_a;
  };
  // Middles of texels: 2 mm a side, the upper row at z = -1.
  for (int i = 0; i < 4; ++i) {
    const auto x = 7 + 2 * static_cast<float>(i);
    CHECK(at({x, 5, -1}).x == doctest::Approx(0));
    CHECK(at({x, 5, -1}).y == doctest::Approx(2.0 * i));
    CHECK(at({x, 5.9f, 1}).x == doctest::Approx(8));
  }
  CHECK(at({10, 5, -1}).y == doctest::Approx(3));  // between two
  CHECK(at({10, 5, 0}).x == doctest::Approx(4));
  for (const glm::vec3& outside : {glm::vec3(5.9f, 5, 0), {14.1f, 5, 0}, {10, 6.1f, 0}, {10, 3.9f, 0}, {10, 5, 2.1f}}) {
    CHECK(at(outside) == base.sigma_a);
  }
  edit.operation = Edit::Operation::add;
  CHECK(at({9, 5, -1}).y == doctest::Approx(0.2 + 2));
  edit.operation = Edit::Operation::multiply;
  CHECK(at({9, 5, -1}).y == doctest::Approx(0.2 * 2));
  CHECK(at({9, 5, -1}).z == doctest::Approx(0));
  edit.softness = 0.5f;
  CHECK(at({14, 5, 1}).x == doctest::Approx(0.5 * (0.1 + 0.8)));
}

TEST_CASE("the luminance of a mask is how much of an edit arrives, beside its depth and stroke") {
  Edit edit{.operation = Edit::Operation::set, .sigma_a = glm::vec3(1), .depth_to = 1, .placement = flat};
  edit.mask = steps();
  const auto share = [&](const glm::vec3& place, float depth) {
    const glm::vec3 found = EditArrays(std::span(&edit, 1)).apply(base, place, depth, 0.1f).sigma_a;
    return (found.x - base.sigma_a.x) / (1 - base.sigma_a.x);
  };
  CHECK(share({13, 5, -1}, 0) == doctest::Approx(0.7152 * 0.75));
  CHECK(share({7, 5, -1}, 0) == doctest::Approx(0));
  CHECK(share({7, 5, 1}, 0.9f) == doctest::Approx(1));
  CHECK(share({7, 5, 1}, 1.1f) == doctest::Approx(0));
  edit.stroke = {{7, 5, 1}};
  edit.radius = 1;
  CHECK(share({7, 5, 1}, 0) == doctest::Approx(1));
  CHECK(share({9, 5, 1}, 0) == doctest::Approx(0));
}

TEST_CASE("an image that several edits stamp is put once") {
  Edit edit{.operation = Edit::Operation::set, .sigma_a = glm::vec3(8), .placement = flat, .image = steps()};
  Edit masked = edit;
  masked.mask = steps();
  const std::vector<Edit> all{edit, edit, masked, edit};
  const EditArrays arrays(all);
  CHECK(arrays.texels.size() == edit.image->texels.size() + masked.mask->texels.size());
  CHECK(arrays.edits[3].image.first == 0);
  CHECK(arrays.edits[2].mask.first == edit.image->texels.size());
}

TEST_CASE("what is finer in an image than the nodes are apart is taken together") {
  Image stripes{256, 256, {}};
  for (std::uint32_t i = 0; i < 256 * 256; ++i) stripes.texels.emplace_back(static_cast<float>(i % 2));
  Edit edit{.operation = Edit::Operation::set, .sigma_a = glm::vec3(1), .placement = Placement{.size = {64, 64, 64}}};
  edit.image = std::make_shared<const ImagePyramid>(pyramid_of(stripes, 1024));
  const EditArrays arrays(std::span(&edit, 1));
  const glm::vec3 place(3.125f, 1, 0);  // in the middle of a texel
  CHECK(std::abs(arrays.apply(base, place, 0, 0.25f).sigma_a.x - 0.5f) > 0.49f);
  CHECK(arrays.apply(base, place, 0, 1).sigma_a.x == doctest::Approx(0.5));
  CHECK(arrays.apply(base, place, 0, 1000).sigma_a.x == doctest::Approx(0.5));
}

TEST_CASE("what an edit cannot be is refused by its field") {
  const auto said = [](const Edit& edit) -> std::string {
    try {
      check_edit(edit);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const glm::vec3 one(1);
  CHECK(said({.sigma_a = one}).empty());
  CHECK(said({.operation = Edit::Operation::add, .sigma_a = -one}).empty());
  CHECK(said({}).starts_with("sigma_s_prime, sigma_a: found neither"));
  CHECK(said({.sigma_a = -one}).starts_with("sigma_a: found -1"));
  CHECK(said({.sigma_s_prime = glm::vec3(NAN)}).starts_with("sigma_s_prime: found"));
  CHECK(said({.sigma_a = one, .stroke = {{0, 0, 0}}}).starts_with("radius: found 0"));
  CHECK(said({.sigma_a = one, .radius = 1}).starts_with("radius: found 1"));
  CHECK(said({.sigma_a = one, .stroke = {{0, INFINITY, 0}}, .radius = 1}).starts_with("stroke: found inf"));
  CHECK(said({.sigma_a = one, .depth_from = -1}).starts_with("depth: found -1"));
  CHECK(said({.sigma_a = one, .depth_from = 2, .depth_to = 2}).starts_with("depth: found 2"));
  CHECK(said({.sigma_a = one, .softness = -1}).starts_with("softness: found -1"));
  CHECK(said({.sigma_a = one, .mask = steps()}).starts_with("placement: found none"));
  const auto placed = [&](const Placement& placement) { return said({.sigma_a = one, .placement = placement}); };
  CHECK(placed(flat).empty());
  CHECK(placed({.size = {1, 0, 1}}).starts_with("size: found 0"));
  CHECK(placed({.direction = {0, 0, 0}, .size = one}).starts_with("direction: found 0"));
  CHECK(placed({.direction = {0, 2, 0}, .size = one}).starts_with("up: found 0 or a direction along"));
  CHECK(placed({.centre = {NAN, 0, 0}, .size = one}).starts_with("centre: found"));
}

TEST_CASE("the depth in a box is the distance to its nearest side") {
  const float size = 8;
  const QuadGraph graph = QuadGraph::parse(box_graph({5}, size), "box");
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(0, size);
  std::vector<glm::vec3> points = {{0, 0, 0}, {4, 4, 4}, {0, 3, 3}, {9, 4, 4}, {-3, -4, 4}};
  for (int i = 0; i < 500; ++i) points.emplace_back(place(random), place(random), place(random));
  const std::vector<float> depth = depth_below_surface(graph.levels()[0], points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::vec3& p = points[i];
    const float sides = std::min({p.x, p.y, p.z, size - p.x, size - p.y, size - p.z});
    const glm::vec3 away = p - glm::clamp(p, glm::vec3(0), glm::vec3(size));
    const float expected = sides >= 0 ? sides : std::sqrt(glm::dot(away, away));
    CHECK(depth[i] == doctest::Approx(expected).epsilon(1e-5));
  }
}
