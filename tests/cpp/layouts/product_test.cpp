// Every layout gives the product and the steps of the smoother that it should, on the device, without a message of the
// validation layer.
#include <doctest/doctest.h>

#include <cmath>

#include "tests/cpp/fixtures/checked_context.h"
#include "tests/cpp/fixtures/test_levels.h"
#include "tools/layouts/study.h"

using namespace quadgraph;
using namespace quadgraph::layouts;

namespace {

// A level whose rows do not fill the last slice, of 1000 vertices, with a material and values of no symmetry.
struct Body {
  OwnedLevel owned = box_level(9, 10.0f, 0.2f);
  Level level = owned.view();
  Model model;
  Matrix matrix;
  Vectors vectors;

  Body(Model model_in, const std::string& material) : model(model_in) {
    const layouts::Scene scene = scene_of(level, material);
    const Problem problem{Method::fem, Source::buried, model, scene.optical, scene.eta};
    matrix = matrix_of(level, problem, scene.at_vertices);
    vectors = {field(1.0, 0.37), field(0.2, 1.1), field(0.5, 0.73)};
  }

  std::vector<Field> field(double mean, double step) const {
    std::vector<Field> fields(level.vertex_count());
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const double t = step * static_cast<double>(i);
      fields[i].phi = glm::dvec3(mean) + 0.3 * glm::dvec3(std::sin(t), std::cos(t), std::sin(2 * t));
      if (model == Model::sp3) fields[i].phi2 = 0.2 * glm::dvec3(std::cos(3 * t), std::sin(t), std::cos(t));
    }
    return fields;
  }

  Vectors kept(int kind) const {
    const auto through = [&](const std::vector<Field>& fields, int vectors_kind) {
      return unpack_fields(pack_fields(fields, model, vectors_kind), fields.size(), model, vectors_kind);
    };
    return {through(vectors.x, kind), through(vectors.b, VECTORS_PACKED), through(vectors.d, kind)};
  }
};

bool sums(const Variant& variant) {
  return variant.operation == Operation::product_dot || variant.operation == Operation::product_then_dot;
}

void check_variant(Bench& bench, const Body& body, const Variant& variant) {
  CAPTURE(variant.group);
  CAPTURE(variant.name);
  const Outcome outcome = bench.run(variant);
  const Vectors kept = body.kept(variant.layout.vectors);
  const std::vector<Field> expected =
      exact_step(represented(body.matrix, variant.layout), body.matrix.rows.diagonal, variant.operation, kept);
  // Single precision, or the rounding of results to half.
  const double tolerance = variant.layout.vectors == VECTORS_HALF ? 5e-4 : 1e-6;
  CHECK(relative_difference(outcome.y, expected) < tolerance);
  if (!sums(variant)) return;
  glm::dvec3 total{0};
  for (std::size_t i = 0; i < expected.size(); ++i) total += dot(kept.x[i], expected[i]);
  for (int c = 0; c < 3; ++c) CHECK(outcome.dot[c] == doctest::Approx(total[c]).epsilon(1e-5));
}

void check_all(Model model, const std::string& material) {
  CAPTURE(material);
  CheckedContext device;
  const Body body(model, material);
  Bench bench(device.context, body.matrix, body.vectors);
  std::size_t run = 0;
  for (const Variant& variant : all_variants()) {
    const std::string refused = bench.refused(variant);
    if (refused.empty()) {
      check_variant(bench, body, variant);
      ++run;
    } else {
      MESSAGE(variant.name << " skipped: " << refused);
    }
  }
  CHECK(run >= 25);
}

}  // namespace

TEST_CASE("every layout gives the steps it should, even and uneven, diffusion and sp3") {
  for (Model model : {Model::diffusion, Model::sp3}) {
    for (const char* material : {"marble", "checker:20"}) check_all(model, material);
  }
}

TEST_CASE("bodies beside each other give the product of each") {
  CheckedContext device;
  const Body body(Model::sp3, "marble");
  const Matrix twice = repeated(body.matrix, 2);
  REQUIRE(twice.count() == 2048);
  Vectors vectors;
  for (int copy = 0; copy < 2; ++copy) {
    vectors.x.insert(vectors.x.end(), body.vectors.x.begin(), body.vectors.x.end());
    vectors.x.resize(1024 * (copy + 1));
  }
  vectors.b = vectors.d = vectors.x;
  Bench bench(device.context, twice, vectors);
  Variant variant;
  variant.kernel = "product";
  const std::vector<Field> y = bench.run(variant).y;
  const std::vector<Field> expected = quadgraph::apply(body.matrix.rows, body.vectors.x);
  for (std::size_t first : {std::size_t{0}, std::size_t{1024}}) {
    CHECK(relative_difference(std::span(y).subspan(first, expected.size()), expected) < 1e-6);
  }
}
