// Deformers and mean value coordinates on the CPU, against closed forms.
#include "engine/deform/deform.h"

#include <doctest/doctest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "engine/base/error.h"
#include "engine/deform/mean_value.h"
#include "tests/cpp/fixtures/deform_fixtures.h"

using namespace quadgraph;

namespace {

const RestBox box{{-1, 0, -2}, {3, 10, 4}};

glm::dvec3 moved(const Deformer& deformer, const glm::vec3& p) {
  check_deformer(deformer);
  return deformed(std::span(&deformer, 1), box, {}, std::span(&p, 1))[0];
}

bool near(const glm::dvec3& a, const glm::dvec3& b, double within = 1e-5) {
  return glm::distance(a, b) < within;
}

glm::dvec3 sum_of(const std::vector<double>& weight, const std::vector<glm::dvec3>& points) {
  glm::dvec3 sum(0);
  for (std::size_t k = 0; k < weight.size(); ++k) sum += weight[k] * points[k];
  return sum;
}

}  // namespace

TEST_CASE("twist, taper and stretch do what they say along their range, and nothing before it") {
  const glm::dvec3 axis_at(1, 0, 1);  // the middle of the box, across the axis
  Deformer twist{.kind = DeformerKind::twist, .begin = 0.2, .end = 0.7, .degrees = 90};
  CHECK(near(moved(twist, {3, 1.5f, 4}), {3, 1.5, 4}));
  CHECK(near(moved(twist, {3, 9, 1}), {1, 9, -1}));  // past the end: a quarter turn from x to -z
  const glm::dvec3 half = moved(twist, {3, 4.5f, 1});
  CHECK(half.x - axis_at.x == doctest::Approx(std::sqrt(2.0)));
  CHECK(half.z - axis_at.z == doctest::Approx(-std::sqrt(2.0)));

  Deformer taper{.kind = DeformerKind::taper, .begin = 2, .end = 7, .range_in_mm = true, .factor = 0.5};
  CHECK(near(moved(taper, {3, 2, 4}), {3, 2, 4}));
  CHECK(near(moved(taper, {3, 4.5f, 4}), {2.5, 4.5, 3.25}));
  CHECK(near(moved(taper, {3, 9, 4}), {2, 9, 2.5}));

  Deformer stretch{.kind = DeformerKind::stretch, .begin = 0.2, .end = 0.7, .factor = 3};
  CHECK(near(moved(stretch, {3, 1, 4}), {3, 1, 4}));
  CHECK(near(moved(stretch, {3, 4.5f, 4}), {3, 9.5, 4}));
  CHECK(near(moved(stretch, {3, 9, 4}), {3, 19, 4}));
}

TEST_CASE("a bend makes an arc of the axis and turns what lies behind it") {
  Deformer bend{.kind = DeformerKind::bend, .begin = 0, .end = 1, .degrees = 90};
  const double radius = 10 / (std::numbers::pi / 2);
  CHECK(near(moved(bend, {1, 0, 1}), {1, 0, 1}));
  CHECK(near(moved(bend, {1, 10, 1}), {1 + radius, radius, 1}));
  CHECK(near(moved(bend, {3, 10, 4}), {1 + radius, radius - 2, 4}));  // the section has turned: x is -y now
  CHECK(near(moved(bend, {1, 12, 1}), {1 + radius + 2, radius, 1}));  // straight on
  double length = 0;
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 a = moved(bend, {1, 0.1f * static_cast<float>(i), 1});
    length += glm::distance(a, moved(bend, {1, 0.1f * static_cast<float>(i + 1), 1}));
  }
  CHECK(length == doctest::Approx(10).epsilon(1e-4));
  bend.degrees = 0;
  CHECK(near(moved(bend, {3, 7, -2}), {3, 7, -2}, 1e-12));
}

TEST_CASE("a transform scales, turns and moves, about its centre") {
  Deformer transform{.kind = DeformerKind::transform,
                     .axis = {0, 0, 2},
                     .centre = glm::dvec3(1, 1, 0),
                     .degrees = 90,
                     .scale = {2, 1, 1},
                     .translate = {0, 0, 5}};
  CHECK(near(moved(transform, {2, 1, 3}), {1, 3, 8}));
  CHECK(!is_rigid(transform));
  transform.scale = glm::dvec3(1);
  CHECK(is_rigid(transform));
  const std::vector<Deformer> list = {{.kind = DeformerKind::twist, .degrees = 3}, transform, transform};
  CHECK(without_rigid_end(list).size() == 1);
}

TEST_CASE("a lattice whose points move by an affine map moves all by it, and only what is near by one point") {
  const glm::dvec3 shift(0.3, -0.2, 0.1), slope(0.1, 0.05, -0.2);
  for (const LatticeBasis basis : {LatticeBasis::bezier, LatticeBasis::linear}) {
    CAPTURE(static_cast<int>(basis));
    Deformer lattice{.kind = DeformerKind::lattice, .size = {3, 4, 2}, .basis = basis};
    for (int z = 0; z < 2; ++z) {
      for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 3; ++x) {
          lattice.displacements.push_back(shift + slope * glm::dvec3(-1 + 2.0 * x, 10.0 * y / 3, -2 + 6.0 * z));
        }
      }
    }
    const glm::dvec3 p(2.3, 7.7, 1.1);
    CHECK(near(moved(lattice, glm::vec3(p)), p + shift + slope * p, 2e-6));
    for (glm::dvec3& d : lattice.displacements) d = glm::dvec3(0);
    lattice.displacements[0] = {0, 0, 1};
    CHECK(near(moved(lattice, {-1, 0, -2}), {-1, 0, -1}));
    CHECK(near(moved(lattice, {3, 10, 4}), {3, 10, 4}));
    const double reach = moved(lattice, {1, 5, -2}).z + 2;  // the linear one does not reach as far as here
    CHECK((reach > 1e-3) == (basis == LatticeBasis::bezier));
  }
}

TEST_CASE("mean value coordinates reproduce points inside, on and outside a cage") {
  const Deformer cage = bumpy_cage(box);
  const auto check = [&](const glm::dvec3& p) {
    const std::vector<double> weight = mean_value_weights(cage.cage, cage.triangles, p);
    double sum = 0;
    for (const double w : weight) sum += w;
    CHECK(sum == doctest::Approx(1));
    CHECK(glm::distance(sum_of(weight, cage.cage), p) < 5e-6);  // the cage is 12 mm high
    return weight;
  };
  for (const glm::dvec3& p : {glm::dvec3(0.1, 0.2, -0.3), glm::dvec3(2, 9, 3), glm::dvec3(-0.5, 0.2, 3.9)}) check(p);
  check(glm::dvec3(40, 25, -30));
  const glm::dvec3 corner = cage.cage[3];
  CHECK(check(corner)[3] == 1);
  const glm::uvec3& t = cage.triangles[5];
  const glm::dvec3 a = cage.cage[t.x], b = cage.cage[t.y], c = cage.cage[t.z];
  const std::vector<double> on_face = check(0.2 * a + 0.3 * b + 0.5 * c);
  CHECK(on_face[t.z] == doctest::Approx(0.5));
  CHECK(check(0.25 * a + 0.75 * b)[t.y] == doctest::Approx(0.75));
  // Points very near to a face, and to its plane beside it, on both sides.
  const glm::dvec3 n = glm::normalize(glm::cross(b - a, c - a));
  for (const double away : {1e-3, 1e-6, 1e-8, 1e-11, -1e-6, -1e-9}) {
    check(0.2 * a + 0.3 * b + 0.5 * c + away * n);
    check(a + 1.5 * (b - a) + 0.9 * (c - a) + away * n);
  }
  for (const double w : check(glm::dvec3(1, 5, 1))) CHECK(w > 0);
}

TEST_CASE("a cage whose vertices move by an affine map moves all by it; at rest nothing moves") {
  Deformer cage = bumpy_cage(box);
  const glm::dvec3 p(0.7, 4.3, 2.1);
  CHECK(near(moved(cage, glm::vec3(p)), p, 1e-6));
  for (glm::dvec3& q : cage.moved) q = sheared(q);
  CHECK(near(moved(cage, glm::vec3(p)), sheared(p), 1e-6));
  // After another deformer it adds what it would have added at rest.
  const std::vector<Deformer> list = {{.kind = DeformerKind::transform, .translate = {100, 0, 0}}, cage};
  const glm::vec3 single(p);
  CHECK(near(deformed(list, box, {}, std::span(&single, 1))[0], sheared(p) + glm::dvec3(100, 0, 0), 1e-5));
}

TEST_CASE("deformers that make no sense are refused by field") {
  const auto refused = [](const Deformer& deformer, const char* word) {
    CHECK_THROWS_WITH_AS(check_deformer(deformer), doctest::Contains(word), InputError);
  };
  refused({.kind = DeformerKind::twist, .axis = {0, 0, 0}}, "twist, axis");
  refused({.kind = DeformerKind::twist, .begin = 1, .end = 1}, "range");
  refused({.kind = DeformerKind::twist, .degrees = std::nan("")}, "degrees");
  refused({.kind = DeformerKind::bend, .towards = {0, 3, 0}}, "towards");
  refused({.kind = DeformerKind::taper, .factor = 0}, "factor");
  refused({.kind = DeformerKind::transform, .scale = {1, -1, 1}}, "scale");
  refused({.kind = DeformerKind::lattice, .size = {2, 17, 2}}, "size");
  refused({.kind = DeformerKind::lattice, .size = {2, 2, 2}}, "8, one for each");
  Deformer cage = bumpy_cage(box);
  cage.triangles.pop_back();
  refused(cage, "closed");
  cage = bumpy_cage(box);
  cage.moved.pop_back();
  refused(cage, "moved");
  refused({.kind = DeformerKind::displaced}, "shapes");
  CHECK_THROWS_WITH_AS(from_name<DeformerKind>("melt"), doctest::Contains("twist, bend"), InputError);
}
