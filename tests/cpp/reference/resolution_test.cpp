// What is known of an answer before it is solved for: elements that are too deep, bodies that are too thin.
#include "engine/reference/resolution.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "engine/optics/half_space.h"
#include "shaders/transport/element_loss.h"
#include "tests/cpp/fixtures/graph_cases.h"

using namespace quadgraph;

namespace {

constexpr std::array<float, 1> usual_index = {1.3f};

double error_of(double albedo, double depth, Model model) {
  const LayeredHalfSpace found = layered_half_space(albedo, 1.3, depth, model);
  return found.reflectance / found.exact - 1;
}

gpu::Optical medium(float sigma_s_prime, float sigma_a) {
  return {glm::vec3(sigma_s_prime), glm::vec3(sigma_a)};
}

}  // namespace

// What the blocks of the system of 60 mean free paths of layers, solved directly in NumPy, leave.
TEST_CASE("layers of elements reflect what their linear system says") {
  struct Case {
    double albedo, depth;
    Model model;
    double error;
  };
  const std::array<Case, 8> cases = {{{.9, 1 / .3, Model::sp3, .1038},
                                      {.99, 10, Model::sp3, .0713},
                                      {.5, 10, Model::sp3, -.1386},
                                      {.02, 1, Model::sp3, .0432},
                                      {.7, 100, Model::sp3, -.8458},
                                      {.5, 1 / .3, Model::diffusion, .1013},
                                      {.2, 10, Model::diffusion, -.3693},
                                      {.9, 1 / 3., Model::diffusion, .0016}}};
  for (const Case& one : cases) {
    CAPTURE(one.albedo);
    CAPTURE(one.depth);
    CHECK(std::abs(error_of(one.albedo, one.depth, one.model) - one.error) < 1e-4);
  }
}

TEST_CASE("thin layers are of second order, and without absorption all light comes back from any") {
  for (const Model model : {Model::diffusion, Model::sp3}) {
    const double coarse = error_of(.8, .2, model), fine = error_of(.8, .1, model);
    CHECK(std::log2(coarse / fine) == doctest::Approx(2).epsilon(.05));
    for (const double depth : {.01, 1., 100., 1e4}) {
      CHECK(std::abs(error_of(1, depth, model)) < 1e-3);
      CHECK(std::isfinite(layered_half_space(0, 1.3, depth, model).decay));
      CHECK(std::isfinite(error_of(2. / 3, depth, model)));
    }
  }
}

TEST_CASE("the depth of elements is measured over open faces, the chord over the whole body") {
  const OwnedLevel owned = box_level(3, 6.0f, 0.0f);
  Level level = owned.view();
  const std::vector<SurfaceSample> samples = surface_samples(level);
  CHECK(samples.size() == level.faces.size());
  double area = 0;
  for (const SurfaceSample& sample : samples) {
    CHECK(sample.depth <= doctest::Approx(2));
    area += sample.area;
  }
  CHECK(area == doctest::Approx(6 * 6 * 6));
  CHECK(mean_chord(level) == doctest::Approx(4));
  const std::vector<std::uint32_t> kinds(level.faces.size(), face_reflecting);
  level.face_kinds = kinds;
  CHECK(surface_samples(level).empty());
  CHECK(std::isinf(mean_chord(level)));
}

TEST_CASE("edges inside are those of the regular tets of the same volume, surface left out") {
  const OwnedLevel coarse = box_level(6, 6.0f, 0.0f), fine = box_level(12, 6.0f, 0.0f);
  CHECK(inside_edge(coarse.view()) / inside_edge(fine.view()) == doctest::Approx(2).epsilon(.02));
  CHECK(inside_edge(coarse.view()) > 0.7);
  CHECK(inside_edge(coarse.view()) < 1.5);
}

// A ball of radius 10 mm, on TetGen's tets of 3 mm: its far side is 12 to 16% too dark (tests/python/engine).
TEST_CASE("words are said of elements inside that are large for light that crosses the body") {
  const std::vector<gpu::Optical> medium_of_ball = {medium(2, .01f)};
  const double chord = 40 / 3.;
  CHECK(inside_warning(medium_of_ball, 1.1, chord).empty());
  const std::string said = inside_warning(medium_of_ball, 3, chord);
  CAPTURE(said);
  CHECK(said.find("3 mm are coarse") != std::string::npos);
  CHECK(said.find("about 13% too weak") != std::string::npos);
  CHECK(said.find("--for-material") != std::string::npos);
  // Nothing crosses it, nothing scatters, and a body a tenth as large with elements as small.
  CHECK(inside_warning(std::vector<gpu::Optical>{medium(2, 1)}, 3, chord).empty());
  CHECK(inside_warning(std::vector<gpu::Optical>{medium(0, .01f)}, 3, chord).empty());
  CHECK(inside_warning(medium_of_ball, .1, chord / 10).empty());
}

TEST_CASE(
    "words are said of elements deeper than the modes can follow, of thin bodies, and of diffusion that absorbs") {
  const std::vector<SurfaceSample> samples = {{2.0, 1.0, 0}};
  const std::vector<gpu::Optical> clear = {medium(.9f, .1f)}, dark = {medium(.2f, 1.8f)};
  CHECK(mesh_warning(resolution_of(samples, clear, usual_index, Model::sp3)).empty());
  CHECK(mesh_warning(resolution_of(samples, dark, usual_index, Model::sp3)).find("decay lengths") != std::string::npos);
  CHECK(resolution_of(samples, dark, usual_index, Model::sp3).error > .05);
  CHECK(model_warning(clear, usual_index, 10, Source::buried, Model::sp3).empty());
  CHECK(model_warning(clear, usual_index, .5, Source::buried, Model::sp3).find("0.5 mean free paths") !=
        std::string::npos);
  CHECK(model_warning(dark, usual_index, 10, Source::buried, Model::sp3).empty());
  CHECK(model_warning(dark, usual_index, 10, Source::buried, Model::diffusion).find("sp3 is not") != std::string::npos);
  const std::vector<gpu::Optical> white = {medium(1, 0)}, none = {medium(0, 0)};
  CHECK(model_warning(white, usual_index, .1, Source::buried, Model::diffusion).empty());
  CHECK(model_warning(none, usual_index, .1, Source::buried, Model::sp3).empty());
  CHECK(resolution_of(samples, none, usual_index, Model::sp3).error == 0);
}

TEST_CASE("light deep inside falls at the rate that isotropic scattering has") {
  for (const float albedo : {.2f, .5f, .8f, .95f, .999f}) {
    CAPTURE(albedo);
    double low = 1e-6, high = 1;
    for (int step = 0; step < 60; ++step) {
      const double k = (low + high) / 2;
      (double{albedo} * std::atanh(k) < k ? low : high) = k;
    }
    CHECK(static_cast<double>(gpu::decay_rate(medium(2 * albedo, 2 * (1 - albedo))).x) ==
          doctest::Approx(2 * low).epsilon(.006));
  }
}

TEST_CASE("sweeps see of a dense body what was measured, and all of one that its elements resolve") {
  // Random walks on balls and scans: exitance of lit faces that sweeps found, over that of the walks.
  struct Measured {
    float albedo, depth, eta;  // depth in mean free paths
    double seen;
  };
  for (const Measured& m :
       {Measured{.9f, 15.0f, 1.5f, .684}, Measured{.85f, 14.7f, 1.2f, .653}, Measured{.98f, 5.2f, 1.33f, 1.001},
        Measured{.6f, 16.2f, 1.33f, .527}, Measured{.6f, 5.9f, 1.5f, .869}, Measured{.9f, 11.6f, 1.2f, .796},
        Measured{.4f, 7.7f, 1.5f, .795}, Measured{.98f, 19.4f, 1.0f, .910}}) {
    CAPTURE(m.albedo);
    CAPTURE(m.depth);
    const gpu::Optical optical = medium(m.albedo, 1 - m.albedo);
    CHECK(static_cast<double>(gpu::seen_of_element(optical, m.depth, m.eta).x) == doctest::Approx(m.seen).epsilon(.05));
    CHECK(gpu::seen_of_element(optical, .2f, m.eta).x == 1);
    const std::vector<SurfaceSample> samples = {{double{m.depth}, 1.0, 0}};
    const double unknown = resolution_of(samples, {{optical}}, {&m.eta, 1}, Model::sp3).corrected;
    CHECK(unknown < .15 * (1 - m.seen) + .005);
    CHECK(unknown > .05 * (1 - m.seen) - .005);
  }
  const gpu::Optical clear = medium(0, 0), white = medium(3, 0);
  CHECK(gpu::seen_of_element(clear, 1e3f, 1.3f) == glm::vec3(1));
  CHECK(gpu::seen_of_element(white, 1e3f, 1.3f) == glm::vec3(1));
}

TEST_CASE("sweeps settle slowly where elements are deep and little is absorbed") {
  const auto slow = [](float albedo, double depth) {
    const std::vector<gpu::Optical> optical = {medium(albedo, 1 - albedo)};
    return resolution_of(std::vector<SurfaceSample>{{depth, 1.0}}, optical, usual_index, Model::sp3).slow;
  };
  CHECK(slow(.999f, 6) > .9);
  CHECK(slow(.999f, 6) <= 1);
  CHECK(slow(.999f, .1) < .05);
  CHECK(slow(.5f, 6) < .01);
}
