// What the layouts keep of an operator, on the CPU.
#include <doctest/doctest.h>

#include <cmath>

#include "tests/cpp/fixtures/test_levels.h"
#include "tools/layouts/krylov.h"
#include "tools/layouts/scene.h"
#include "tools/layouts/variants.h"

using namespace quadgraph;
using namespace quadgraph::layouts;

namespace {

struct Body {
  OwnedLevel owned = box_level(5, 10.0f, 0.2f);
  Matrix matrix;

  Body(Model model, const std::string& material) {
    const Level level = owned.view();
    const layouts::Scene scene = scene_of(level, material);
    matrix = matrix_of(level, {Method::fem, Source::buried, model, scene.optical, scene.eta}, scene.at_vertices);
  }
};

double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

double largest(const Block& block) {
  return std::max({largest(block.a11), largest(block.a12), largest(block.a22)});
}

Block minus(const Block& a, const Block& b) {
  return {a.a11 - b.a11, a.a12 - b.a12, a.a22 - b.a22};
}

Block at(const Rows& rows, std::uint32_t i, std::uint32_t j) {
  for (std::uint32_t e = rows.offset[i]; e < rows.offset[i + 1]; ++e) {
    if (rows.column[e] == j) return rows.weight[e];
  }
  return {};
}

// Largest difference of the entries, and of the sums of rows, of two operators of one pattern.
struct Distance {
  double entries = 0, sums = 0;
};

Distance distance(const Rows& a, const Rows& b) {
  Distance result;
  for (std::size_t e = 0; e < a.weight.size(); ++e) {
    result.entries = std::max(result.entries, largest(minus(a.weight[e], b.weight[e])));
  }
  for (std::uint32_t i = 0; i < a.size(); ++i) {
    result.sums = std::max(result.sums, largest(minus(row_sum(a, i), row_sum(b, i))));
  }
  return result;
}

double largest_entry(const Rows& rows) {
  double most = 0;
  for (const Block& w : rows.weight) most = std::max(most, largest(w));
  return most;
}

}  // namespace

TEST_CASE("geometry and a uniform material make the operator that the engine assembles") {
  for (Model model : {Model::diffusion, Model::sp3}) {
    const Body body(model, "skin1");
    const Layout geometry{.entries = ENTRIES_GEOMETRY};
    const Distance d = distance(represented(body.matrix, geometry), body.matrix.rows);
    // Coefficients are single precision in both.
    CHECK(d.entries < 1e-12 * largest_entry(body.matrix.rows));
    CHECK(d.sums < 1e-12 * largest_entry(body.matrix.rows));
    for (const auto& coefficients : {body.matrix.tet_means, body.matrix.at_vertices}) {
      CHECK(distance(edge_averaged(body.matrix, coefficients), body.matrix.rows).entries <
            1e-12 * largest_entry(body.matrix.rows));
    }
  }
}

TEST_CASE("half entries stay symmetric, are right to half an ulp of the largest and keep the sums of rows") {
  for (Model model : {Model::diffusion, Model::sp3}) {
    const Body body(model, "checker:20");
    const Rows& exact = body.matrix.rows;
    const Rows half = represented(body.matrix, {.entries = ENTRIES_HALF});
    const Distance d = distance(half, exact);
    CHECK(d.entries > 0);
    CHECK(d.entries <= std::exp2(-11) * largest_entry(exact));
    CHECK(d.sums < 1e-12 * largest_entry(exact));
    for (std::uint32_t i = 0; i < half.size(); ++i) {
      for (std::uint32_t e = half.offset[i]; e < half.offset[i + 1]; ++e) {
        CHECK(largest(minus(half.weight[e], at(half, half.column[e], i))) == 0);
      }
    }
  }
}

TEST_CASE("sorting rows within windows stores every entry, with less padding") {
  const Body body(Model::diffusion, "marble");
  const std::uint64_t entries = body.matrix.entries();
  const std::uint64_t unsorted = pack(body.matrix, {}).slots;
  const std::uint64_t sorted = pack(body.matrix, {.window = 256}).slots;
  CHECK(pack(body.matrix, {.rows = ROWS_CSR}).slots == entries);
  CHECK(sorted >= entries);
  CHECK(sorted < unsorted);
  CHECK(unsorted < pack(body.matrix, {.rows = ROWS_ELL}).slots);
}

TEST_CASE("16-bit columns are refused where a slice reaches three places far apart") {
  const Body body(Model::diffusion, "marble");
  const Layout layout{.columns = 16};
  CHECK(refused(body.matrix, layout).empty());
  Matrix far = body.matrix;
  far.rows.column[far.rows.offset[1] - 1] = 100000;  // beside columns near 0: two places
  CHECK(refused(far, layout).empty());
  far.rows.column[far.rows.offset[2] - 1] = 200000;
  CHECK_FALSE(refused(far, layout).empty());
  CHECK(refused(far, {}).empty());
}

TEST_CASE("conjugate gradients solve, and know the smallest eigenvalue and an indefinite matrix") {
  Rows rows;
  rows.offset = {0, 1, 2};
  rows.column = {1, 0};
  rows.weight.assign(2, {.a11 = glm::dvec3(-1), .a12 = {}, .a22 = {}});
  rows.diagonal.assign(2, {.a11 = glm::dvec3(2), .a12 = {}, .a22 = {}});
  const std::vector<Field> b = {{glm::dvec3(1), {}}, {glm::dvec3(0), {}}};
  const Solved solved = solve(rows, b);
  CHECK(solved.x[0].phi.x == doctest::Approx(2.0 / 3));
  CHECK(solved.x[1].phi.y == doctest::Approx(1.0 / 3));
  REQUIRE(solved.least.has_value());
  CHECK(*solved.least == doctest::Approx(0.5));
  rows.weight.assign(2, {.a11 = glm::dvec3(-3), .a12 = {}, .a22 = {}});
  CHECK_FALSE(solve(rows, b).least.has_value());
}
