// Entries as a device stores them.
#include "engine/reference/stored_entries.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/cpp/fixtures/graph_cases.h"
#include "tests/cpp/fixtures/test_graphs.h"

using namespace quadgraph;

namespace {

double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

Block through(const Block& weight, Model model) {
  std::vector<std::uint32_t> words = stored_columns(std::vector<std::uint32_t>{5}, model, EntryFormat::packed);
  store_weight(words, 0, weight, model, EntryFormat::packed);
  const StoredEntry entry = stored_entry(words, 0, model, EntryFormat::packed);
  CHECK(entry.column == 5);
  return entry.weight;
}

}  // namespace

TEST_CASE("a stored column is what it was, whatever weight is stored beside it") {
  const std::vector<std::uint32_t> columns = {0, 1, 0x7ffff, 0x80000, 0xfffff, 0x100000, 0x3fffff};
  // Whole numbers, beyond the stiffness small ones, are exact.
  const glm::dvec3 stiffness(-63, 126, -189);
  const Block weight{stiffness, 2.0 / 3.0 * stiffness + glm::dvec3(4, -5, 6),
                     55.0 / 63.0 * stiffness + glm::dvec3(-7, 8, -9)};
  for (Model model : both_models) {
    std::vector<std::uint32_t> words = stored_columns(columns, model, EntryFormat::packed);
    for (std::size_t e = 0; e < columns.size(); ++e)
      CHECK(largest(stored_entry(words, e, model, EntryFormat::packed).weight.a11) == 0);
    for (std::size_t e = 0; e < columns.size(); ++e) store_weight(words, e, weight, model, EntryFormat::packed);
    for (std::size_t e = 0; e < columns.size(); ++e) {
      const StoredEntry entry = stored_entry(words, e, model, EntryFormat::packed);
      CHECK(entry.column == columns[e]);
      CHECK(entry.weight.a11 == weight.a11);
      if (model != Model::sp3) continue;
      CHECK(largest(entry.weight.a12 - weight.a12) < 1e-5);
      CHECK(largest(entry.weight.a22 - weight.a22) < 1e-5);
    }
  }
}

TEST_CASE("the largest channel is off by no more than half a unit of its last bit, from 1e-9 to 1e9") {
  std::array<double, 2> worst = {0, 0};
  for (Model model : both_models) {
    const double bound = model == Model::sp3 ? 0x1p-12 : 0x1p-11;
    for (int k = 0; k < 2000; ++k) {
      const double size = std::pow(10.0, -9 + 0.009 * k);
      const glm::dvec3 value(size, -0.37 * size, 0.011 * size);
      const Block found = through({value, 0.6 * value, 0.5 * value}, model);
      const double error = largest(found.a11 - value) / size;
      double& most = worst[model == Model::sp3 ? 1 : 0];
      most = std::max(most, error);
      CHECK(error <= bound);
    }
  }
  CHECK(worst[0] > 0x1p-12);  // the bound is no more than it has to be
  CHECK(worst[1] > 0x1p-13);
  CHECK(largest(through({}, Model::diffusion).a11) == 0);
  CHECK(std::isfinite(largest(through({glm::dvec3(1e30), {}, {}}, Model::diffusion).a11)));
}

TEST_CASE("with SP3 masses are rounded by a share of themselves, be they far below the stiffness or far above") {
  const glm::dvec3 stiffness(-0.3, -0.9, -0.04);
  double worst = 0;
  for (int k = 0; k <= 700; ++k) {
    const double mass = std::pow(10.0, -5 + 0.02 * k);
    // What absorption is at most, against relaxation; of a surface the sign may be the other.
    const glm::dvec3 absorption = glm::dvec3(0.8, -0.1, 0.3) * std::min(mass, 50.0);
    const glm::dvec3 relaxation = glm::dvec3(-0.2, 1.0, 0.6) * mass;
    const Block exact{stiffness + absorption, 2.0 / 3.0 * stiffness, 55.0 / 63.0 * stiffness + relaxation};
    const Block found = through(exact, Model::sp3);
    const double all = largest(exact.a11);
    // What a12 and a22 are beyond their shares of a11.
    const glm::dvec3 rest12 = exact.a12 - 2.0 / 3.0 * exact.a11, rest22 = exact.a22 - 55.0 / 63.0 * exact.a11;
    const double error12 = largest(found.a12 - 2.0 / 3.0 * found.a11 - rest12);
    const double error22 = largest(found.a22 - 55.0 / 63.0 * found.a11 - rest22);
    CAPTURE(mass);
    CHECK(largest(found.a11 - exact.a11) <= std::max(0x1p-12 * all, 0x1p-27 * largest(rest22)));
    CHECK(error12 <= 0x1p-7 * largest(rest12) + 0x1p-14 * all);
    CHECK(error22 <= 0x1p-8 * largest(rest22) + 0x1p-14 * all);
    worst = std::max(worst, error22 / largest(rest22));
  }
  CHECK(worst > 0x1p-10);
  const Block odd{glm::dvec3(1), glm::dvec3(1e6), glm::dvec3(-1e9)};
  CHECK(largest(through(odd, Model::sp3).a12 - odd.a12) <= 0x1p-7 * 1e6);
  CHECK(largest(through(odd, Model::sp3).a22 - odd.a22) <= 0x1p-8 * 1e9);
}

TEST_CASE("rounded rows keep their sums and their symmetry, so that no energy is made or lost") {
  const OwnedLevel owned = split_at_centroids(box_level(3, 2.0f));
  const Level level = owned.view();
  const std::vector<gpu::Optical> optical(level.node_count(), {glm::vec3(1.0f, 3.0f, 0.2f), glm::vec3(0.01f)});
  for (Method method : {Method::fem, Method::quadgraph_fv, Method::quadgraph_fdm}) {
    for (Model model : both_models) {
      const Rows exact = assemble(level, {method, Source::buried, model, optical, 1.3});
      const Rows stored = as_packed(exact, model);
      double change = 0;
      for (std::size_t i = 0; i < exact.size(); ++i) {
        Block before = exact.diagonal[i], after = stored.diagonal[i];
        for (std::uint32_t k = exact.offset[i]; k < exact.offset[i + 1]; ++k) {
          before += exact.weight[k];
          after += stored.weight[k];
          change = std::max(change, largest(exact.weight[k].a11 - stored.weight[k].a11));
          const std::uint32_t j = exact.column[k];
          for (std::uint32_t m = exact.offset[j]; m < exact.offset[j + 1]; ++m) {
            if (exact.column[m] != i) continue;
            CHECK(stored.weight[m].a11 == stored.weight[k].a11);
            CHECK(stored.weight[m].a12 == stored.weight[k].a12);
            CHECK(stored.weight[m].a22 == stored.weight[k].a22);
          }
        }
        CHECK(largest(before.a11 - after.a11) <= 1e-12 * largest(exact.diagonal[i].a11));
        CHECK(largest(before.a22 - after.a22) <= 1e-12 * largest(exact.diagonal[i].a11));
      }
      CHECK(change > 0);
    }
  }
}

TEST_CASE("plain entries are single precision") {
  const Block weight{glm::dvec3(-1e-20, 2, 3e20), glm::dvec3(4.1f, -5.7f, 6e-3f), glm::dvec3(-7, 8, 0.1f)};
  for (Model model : both_models) {
    std::vector<std::uint32_t> words =
        stored_columns(std::vector<std::uint32_t>{7, 0xffffffff}, model, EntryFormat::plain);
    for (std::size_t e = 0; e < 2; ++e) store_weight(words, e, weight, model, EntryFormat::plain);
    for (std::size_t e = 0; e < 2; ++e) {
      const StoredEntry entry = stored_entry(words, e, model, EntryFormat::plain);
      CHECK(entry.column == (e == 0 ? 7 : 0xffffffff));
      CHECK(largest(entry.weight.a11 / glm::dvec3(glm::vec3(weight.a11)) - 1.0) == 0);
      if (model == Model::sp3) CHECK(largest(entry.weight.a22 - weight.a22) < 1e-7);
    }
  }
}

TEST_CASE("elements that rounding would harm get plain entries, and so do the published methods") {
  const auto stretched = [](float factor) {
    OwnedLevel level = split_at_corners(box_level(3, 2.0f));
    for (glm::vec3& p : level.vertices) p.z *= factor;
    return level;
  };
  for (const float factor : {1.0f, 2.0f, 1000.0f, 1e-3f}) {
    CAPTURE(factor);
    const OwnedLevel level = stretched(factor);
    const bool near_regular = factor >= 1 && factor <= 2;
    CHECK(format_of(level.view(), Method::fem) == (near_regular ? EntryFormat::packed : EntryFormat::plain));
    CHECK(format_of(level.view(), Method::quadgraph_fv) == EntryFormat::plain);
    CHECK(format_of(level.view(), Method::quadgraph_fdm) == EntryFormat::plain);
  }
  CHECK(format_of(split_at_centroids(box_level(3, 2.0f)).view(), Method::fem) ==
        EntryFormat::plain);  // flat all through
  OwnedLevel one_flat = split_at_corners(box_level(3, 2.0f));
  const glm::uvec4 tet = one_flat.tets.front();
  const glm::vec3 middle = (one_flat.vertices[tet.x] + one_flat.vertices[tet.y] + one_flat.vertices[tet.z]) / 3.0f;
  glm::vec3& apex = one_flat.vertices[tet.w];
  apex = middle + 1e-4f * (apex - middle);
  CHECK(format_of(one_flat.view(), Method::fem) == EntryFormat::plain);
}
