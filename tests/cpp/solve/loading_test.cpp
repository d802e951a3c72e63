// How shaders load arrays, and in which format entries lie, changes no answer.
#include <doctest/doctest.h>

#include "engine/reference/stored_entries.h"
#include "engine/solve/gather_field.h"
#include "engine/vk/arena.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"
#include "tests/cpp/fixtures/solve_fixtures.h"
#include "tests/cpp/fixtures/walk_fixtures.h"

using namespace quadgraph;

namespace {

struct Body {
  vk::Context context;
  QuadGraph graph;
  Simulation simulation;

  Body(std::uint64_t bytes, const std::vector<std::byte>& file)
      : context({.validation = true, .device = "", .texel_bytes = bytes}),
        graph(QuadGraph::parse(file, "box")),
        simulation(context, graph) {
    CHECK(context.arenas()[0].used() == (bytes > 0));
  }
  ~Body() { CHECK(context.validation_messages().empty()); }
};

constexpr std::uint64_t none = 0, plenty = 1ull << 28;

std::vector<glm::vec3> solution(Body& body, const gpu::Material& material, const SolveOptions& options) {
  body.simulation.set_material(material);
  for (std::uint32_t i = 0; i < body.simulation.level_count(); ++i) {
    const Level& level = body.graph.levels()[i];
    std::vector<glm::vec3> q;
    for (std::uint32_t f = 0; f < level.face_count(); ++f) q.push_back(one_side(level.nodes[level.tet_count() + f]));
    body.simulation.set_irradiance(i, q, glm::vec3(1, 0.2f, 0));
  }
  body.simulation.solve(options);
  return body.simulation.surface_field().exitance;
}

}  // namespace

TEST_CASE("arrays read as texels and arrays read through references give the same numbers") {
  const auto file = box_graph({4, 2}, 10.0f);
  Body texels(plenty, file), references(none, file);
  for (Method method : {Method::fem, Method::quadgraph_fv, Method::quadgraph_fdm}) {
    for (Model model : {Model::diffusion, Model::sp3}) {
      for (Source source : {Source::buried, Source::diffuse}) {
        for (const gpu::Material& material : {homogeneous(), veined()}) {
          // The published rows are not positive definite there (solve_behaviour_test.cpp).
          if (method == Method::quadgraph_fdm && material.pattern == gpu::PATTERN_VEINS) continue;
          const SolveOptions options{.method = method, .source = source, .model = model, .tolerance = 1e-5};
          CAPTURE(name_of(method));
          CAPTURE(name_of(model));
          const auto a = solution(texels, material, options), b = solution(references, material, options);
          CHECK(relative_difference(a, b) < 1e-6);
        }
      }
    }
  }
}

TEST_CASE(
    "what finds no room among the texels is read through references, and so is all else of its arena from then on") {
  // Flat tets all through get plain entries, which take more room than the tets; well-shaped ones packed entries.
  const auto flat = box_graph({4, 2}, 10.0f);
  const std::vector<OwnedLevel> well_shaped = {split_at_corners(box_level(6, 10.0f, 0.15f)),
                                               split_at_corners(box_level(3, 10.0f, 0.15f))};
  const auto file = graph_of(well_shaped);
  Body roomy(plenty, file), no_assembly(300'000, file), nothing(1'000, file);
  Body roomy_flat(plenty, flat), little(250'000, flat);
  for (const gpu::Material& material : {homogeneous(), veined()}) {
    for (Model model : {Model::diffusion, Model::sp3}) {
      const SolveOptions options{.model = model, .tolerance = 1e-5};
      const auto expected = solution(roomy, material, options);
      for (Body* narrow : {&no_assembly, &nothing}) {
        CHECK(relative_difference(solution(*narrow, material, options), expected) < 1e-6);
      }
      const auto of_flat = solution(roomy_flat, material, options);
      CHECK(relative_difference(solution(little, material, options), of_flat) < 1e-6);
    }
  }
  const auto bit = [](vk::Place place) { return 1u << vk::arena_of(place); };
  CHECK(roomy.context.arenas().complete() == (1u << vk::arena_count) - 1);
  CHECK(no_assembly.context.arenas().complete() ==
        (bit(vk::Place::read) | bit(vk::Place::rows) | bit(vk::Place::fields)));
  CHECK(little.context.arenas().complete() == (bit(vk::Place::read) | bit(vk::Place::fields)));
  CHECK(nothing.context.arenas().complete() == 0);
}

TEST_CASE("the walk leaves the same power everywhere, whatever light it starts from") {
  Body texels(plenty, box_graph({2}, 4.0f)), references(none, box_graph({2}, 4.0f));
  WalkInput input{.level = box_level(4, 4.0f, 0.3f),
                  .optical = [](const glm::vec3& p) { return optical_of({1.0f, p.x, p.y + p.z}, {0.1f, 0.0f, 0.02f}); },
                  .quarter_q = [](const Lit& lit, std::uint32_t k) { return lit.centre.x * static_cast<float>(k + 1); },
                  .eta = 1.3};
  const std::array<gpu::BeamRecord, 4> beams = {{{gpu::BEAM_DIRECTIONAL, glm::normalize(glm::vec3(1, -0.4f, 0.3f))},
                                                 {gpu::BEAM_POINT, {-3.0f, 1.0f, 2.5f}},
                                                 {gpu::BEAM_LAMBERTIAN, {}},
                                                 {gpu::BEAM_MEAN, {}}}};
  for (const gpu::BeamRecord& beam : beams) {
    for (const Method method : {Method::fem, Method::quadgraph_fv}) {
      CAPTURE(beam.kind);
      CAPTURE(name_of(method));
      input.beam = beam;
      input.method = method;
      const GpuWalk a = walk(texels.context, input), b = walk(references.context, input);
      CHECK(glm::length(total(b.deposit)) > 0);
      CHECK(relative_difference(a.deposit, b.deposit) < 1e-6);
      CHECK(relative_difference(a.unscattered, b.unscattered) < 1e-6);
      CHECK(relative_difference(std::vector{a.power.absorbed}, std::vector{b.power.absorbed}) < 1e-6);
    }
  }
}

TEST_CASE("bodies send each other the same light, also after a move that casts their rays anew") {
  OwnedLevel fine = facing_slabs(4, 10.0f, 2.0f, 2.0f), coarse = facing_slabs(2, 10.0f, 2.0f, 2.0f);
  bake_seen(coarse, 64);
  const auto file = graph_of(std::vector{fine, coarse});
  Body texels(plenty, file), references(none, file);
  const SolveOptions options{.model = Model::diffusion, .tolerance = 1e-5};
  for (const bool moves : {false, true}) {
    CAPTURE(moves);
    for (Body* body : {&texels, &references}) {
      for (std::uint32_t i = 0; moves && i < body->simulation.level_count(); ++i) {
        body->simulation.set_vertices(i, moved(i == 0 ? fine : coarse, bent).vertices);
      }
    }
    const auto a = solution(texels, veined(), options), b = solution(references, veined(), options);
    CHECK(relative_difference(a, b) < 1e-6);
    const SolveReport report = references.simulation.solve(options);
    REQUIRE(report.inter_reflection);
    CHECK(report.energy.re_entered.x > 0.01 * report.energy.entered.x);
    const auto re_entered = texels.simulation.solve(options).energy.re_entered;
    CHECK(relative_difference(std::vector{re_entered}, std::vector{report.energy.re_entered}) < 1e-6);
  }
}

TEST_CASE("view rays gather the same") {
  const auto file = box_graph({4, 2}, 10.0f);
  Body texels(plenty, file), references(none, file);
  for (const gpu::Material& material : {homogeneous(), veined()}) {
    const SolveOptions options{.model = Model::sp3, .tolerance = 1e-5};
    solution(texels, material, options);
    solution(references, material, options);
    std::vector<PassStats> passes;
    const GatherField &a = texels.simulation.gather(Gather::scaled, passes),
                      &b = references.simulation.gather(Gather::scaled, passes);
    const auto points = [](Body& body, const GatherField& field) {
      return vk::download<glm::vec3>(body.context, field.points());  // three per point
    };
    CHECK(relative_difference(points(texels, a), points(references, b)) < 1e-6);
    const auto gathered = vk::download<glm::vec3>(references.context, b.gathered());
    CHECK(std::any_of(gathered.begin(), gathered.end(), [](const glm::vec3& m) { return m.x > 0; }));
    CHECK(relative_difference(vk::download<glm::vec3>(texels.context, a.gathered()), gathered) < 1e-6);
    // What the factor leaves over is a difference; and other sums, in another order, end in other last bits.
    CHECK(relative_difference(vk::download<glm::vec3>(texels.context, a.scale()),
                              vk::download<glm::vec3>(references.context, b.scale())) < 1e-5);
  }
}

TEST_CASE("a body squeezed until packed entries would round too much is solved like one of that shape") {
  const auto squeeze = [](glm::vec3 p) { return p * glm::vec3(0.01f, 0.01f, 10.0f); };
  std::vector<OwnedLevel> levels = {split_at_corners(box_level(4, 10.0f, 0.15f)),
                                    split_at_corners(box_level(2, 10.0f, 0.15f))};
  Body moved(plenty, graph_of(levels));
  for (OwnedLevel& level : levels) {
    for (glm::vec3& p : level.vertices) p = squeeze(p);
  }
  Body fresh(plenty, graph_of(levels));
  const gpu::Material material = homogeneous();
  const SolveOptions options{.model = Model::sp3, .tolerance = 1e-5};
  solution(moved, material, options);  // with packed entries
  for (std::uint32_t i = 0; i < moved.simulation.level_count(); ++i) {
    CHECK(format_of(moved.graph.levels()[i], Method::fem) == EntryFormat::packed);
    CHECK(format_of(fresh.graph.levels()[i], Method::fem) == EntryFormat::plain);
    moved.simulation.set_vertices(i, fresh.graph.levels()[i].vertices);
  }
  CHECK(relative_difference(solution(moved, material, options), solution(fresh, material, options)) < 1e-4);
}
