// Edits of a material, and the depth they may depend on.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/common.hpp>
#include <random>

#include "engine/graph/depth.h"
#include "engine/graph/edit.h"
#include "engine/graph/error.h"
#include "tests/cpp/test_graphs.h"

using namespace quadgraph;

namespace {

const gpu::Optical base{{1, 2, 3}, {0.1f, 0.2f, 0.3f}};

gpu::Optical after(std::initializer_list<Edit> edits, const glm::vec3& place = {}, float depth = 0) {
  const std::vector<Edit> all(edits);
  return EditArrays(all).apply(base, place, depth);
}

}  // namespace

TEST_CASE("an edit everywhere multiplies, adds or sets what it names, in order") {
  using enum Edit::Operation;
  CHECK(after({}).sigma_a == base.sigma_a);
  CHECK(after({{.operation = multiply, .sigma_a = glm::vec3(2)}}).sigma_a == 2.0f * base.sigma_a);
  CHECK(after({{.operation = multiply, .sigma_a = glm::vec3(2)}}).sigma_s_prime == base.sigma_s_prime);
  CHECK(after({{.operation = add, .sigma_s_prime = glm::vec3(-2, 1, 0)}}).sigma_s_prime == glm::vec3(0, 3, 3));
  CHECK(after({{.operation = set, .sigma_a = glm::vec3(5)}}).sigma_a == glm::vec3(5));
  const Edit twice{.operation = multiply, .sigma_a = glm::vec3(2)}, plus{.operation = add, .sigma_a = glm::vec3(1)};
  CHECK(after({twice, plus}).sigma_a.x == doctest::Approx(1.2f));
  CHECK(after({plus, twice}).sigma_a.x == doctest::Approx(2.2f));
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
