// Pictures of several frames: what more samples of a pixel make better, and the blur of a lens.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "engine/base/error.h"
#include "engine/render/picture/frame_offsets.h"
#include "engine/render/picture/picture_mean.h"
#include "tests/cpp/fixtures/checked_engine.h"
#include "tests/cpp/fixtures/display_stage.h"

using namespace quadgraph;

namespace {

constexpr std::uint32_t side = 96;  // pixels of a picture of the cube
const View slanted{.azimuth = 33, .elevation = 21, .orthographic = 4.5f};

struct LitCube : CheckedEngine {
  LitCube() {
    engine.set_material("sigma_s_prime=2/1/0.5,sigma_a=0.1,eta=1.3");
    engine.set_lights({parse_light("directional:-0.3,-0.4,-0.86602540:1/2/3"), parse_light("ambient:0.2")});
    engine.solve();
  }

  Picture picture(std::uint32_t samples, const View& view = slanted, PixelFilter filter = PixelFilter::box) {
    return engine.render(view, {.width = side,
                                .height = side,
                                .samples = samples,
                                .filter = filter,
                                .transmission_roughness = 0.0f});  // without chance
  }
};

double total(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += double{value};
  return sum;
}

// RMS over the pixels that the silhouette crosses in `truth`.
double silhouette_error(const std::vector<float>& alpha, const std::vector<float>& truth) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    if (truth[i] <= 0 || truth[i] >= 1) continue;
    sum += (double{alpha[i]} - double{truth[i]}) * (double{alpha[i]} - double{truth[i]});
    ++count;
  }
  REQUIRE(count > 100);
  return std::sqrt(sum / static_cast<double>(count));
}

// A ball through a lens, ahead of an eye that looks along -z at what is 100 mm away, in frames.
std::vector<float> ball_through_lens(float away, float radius, double aperture, double focus,
                                     PixelFilter filter = PixelFilter::box) {
  constexpr std::uint32_t frames = 64, wide = 200;
  DisplayStage stage(sphere({0, 0, 100 - away}, radius, 3), glm::vec3(1));
  const View view{
      .azimuth = 0, .elevation = 0, .vertical_fov = 10, .eye = glm::vec3(0, 0, 100), .look_at = glm::vec3(0)};
  const Sphere bounds = bounding_sphere(stage.shape.vertices);
  stage.shadows.update(stage.mesh, {{}, bounds});
  stage.refractions.become(1.3f);
  const Camera camera = place_camera(view, bounds, 1);
  PictureMean mean(stage.context);
  for (std::uint32_t i = 0; i < frames; ++i) {
    const FrameOffset offset = frame_offset({i, frames}, filter);
    stage.rasteriser.run({.mesh = stage.mesh,
                          .finest = stage.level,
                          .vertex_exitance = stage.exitance,
                          .vertex_unscattered = stage.unscattered,
                          .shadows = stage.shadows,
                          .frame = {i, frames},
                          .filter = filter},
                         moved(camera, 2.0 * offset.pixel / double{wide}, 0.5 * aperture * offset.lens, focus), wide,
                         wide);
    mean.add(stage.rasteriser.picture(), i);
  }
  return read_picture(stage.context, mean.picture()).alpha;
}

// Pixels: the radius of a disc that is spread as what is covered is, about the middle of the picture.
double spread(const std::vector<float>& alpha) {
  const auto wide = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(alpha.size()))));
  double sum = 0;
  for (std::uint32_t i = 0; i < alpha.size(); ++i) {
    const double x = i % wide + 0.5 - 0.5 * wide, y = i / wide + 0.5 - 0.5 * wide;
    sum += double{alpha[i]} * (x * x + y * y);
  }
  return std::sqrt(2 * sum / total(alpha));
}

}  // namespace

TEST_CASE("quantiles of a filter are symmetric, in order, and spread as its variance says") {
  for (const PixelFilter filter : all_values<PixelFilter>()) {
    CAPTURE(name_of(filter));
    constexpr int count = 2000;
    double square = 0, before = -10;
    for (int k = 0; k < count; ++k) {
      const double place = quantile(filter, (k + 0.5) / count);
      CHECK(place > before);
      CHECK(place == doctest::Approx(-quantile(filter, 1 - (k + 0.5) / count)).epsilon(1e-9));
      square += place * place / count;
      before = place;
    }
    CHECK(square == doctest::Approx(variance(filter)).epsilon(1e-3));
  }
  CHECK(std::sqrt(variance(PixelFilter::gaussian)) == doctest::Approx(0.5).epsilon(0.02));  // less what is cut off
  CHECK(variance(PixelFilter::tent) == doctest::Approx(2 * variance(PixelFilter::box)));
}

TEST_CASE("all samples of a pixel together are spread as its filter says") {
  for (const PixelFilter filter : all_values<PixelFilter>()) {
    CAPTURE(name_of(filter));
    constexpr std::uint32_t frames = 64;
    glm::dvec2 sum(0), square(0);
    for (std::uint32_t index = 0; index < frames; ++index) {
      for (const glm::dvec2 quarter : {glm::dvec2(-0.25, -0.25), {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}}) {
        const glm::dvec2 place = frame_offset({index, frames}, filter).pixel + quarter;
        sum += place / (4.0 * frames);
        square += place * place / (4.0 * frames);
      }
    }
    for (const int axis : {0, 1}) {
      CHECK(std::abs(sum[axis]) < 1e-12);
      CHECK(square[axis] == doctest::Approx(variance(filter)).epsilon(0.02));
    }
  }
}

TEST_CASE("places of coverage are spread as the filter says, in each frame and in all together") {
  for (const PixelFilter filter : all_values<PixelFilter>()) {
    for (const std::uint32_t frames : {1u, 4u, 16u}) {
      CAPTURE(name_of(filter));
      CAPTURE(frames);
      const double wanted = variance(frames == 1 ? PixelFilter::box : filter);
      glm::dvec2 sum(0), square(0);
      for (std::uint32_t index = 0; index < frames; ++index) {
        const CoveragePlaces found = coverage_places({index, frames}, filter);
        const glm::dvec2 moved = frame_offset({index, frames}, filter).pixel * glm::dvec2(1, -1);
        glm::dvec2 of_frame(0);
        for (const glm::vec2& place : found.places) {
          CHECK(std::max(std::abs(place.x), std::abs(place.y)) <= found.reach);
          const glm::dvec2 unmoved = glm::dvec2(place) - moved;
          of_frame += unmoved * unmoved / double{gpu::COVERAGE_PLACES};
          sum += unmoved / (double{gpu::COVERAGE_PLACES} * frames);
        }
        square += of_frame / static_cast<double>(frames);
        for (const int axis : {0, 1}) CHECK(of_frame[axis] == doctest::Approx(wanted).epsilon(0.05));
      }
      for (const int axis : {0, 1}) {
        CHECK(std::abs(sum[axis]) < 1e-6);
        CHECK(square[axis] == doctest::Approx(wanted).epsilon(0.01));
      }
    }
  }
}

TEST_CASE("with a wide filter alpha of few frames is that of many") {
  for (const PixelFilter filter : {PixelFilter::tent, PixelFilter::gaussian, PixelFilter::blackman_harris}) {
    CAPTURE(name_of(filter));
    LitCube cube;
    const double error =
        silhouette_error(cube.picture(16, slanted, filter).alpha, cube.picture(1024, slanted, filter).alpha);
    MESSAGE(name_of(filter), ": ", error, " RMS of alpha along the silhouette");
    CHECK(error < 0.01);
  }
}

TEST_CASE("a wider filter makes edges as much wider, and the body covers as much") {
  // Along an edge: half of what two places are apart by chance, 1/3 of a pixel by the box and 7/15 by the tent.
  const auto width = [](const std::vector<float>& alphas) {
    double sum = 0;
    for (const float alpha : alphas) sum += double{alpha} * (1 - double{alpha});
    return sum;
  };
  const std::vector<float> box = ball_through_lens(100, 7, 0, 100);
  const std::vector<float> tent = ball_through_lens(100, 7, 0, 100, PixelFilter::tent);
  CHECK(total(tent) == doctest::Approx(total(box)).epsilon(1e-3));
  CHECK(width(tent) / width(box) == doctest::Approx(7.0 / 5).epsilon(0.04));
  LitCube cube;
  const Picture sharp = cube.picture(64), soft = cube.picture(64, slanted, PixelFilter::gaussian);
  CHECK(total(soft.scattered) == doctest::Approx(total(sharp.scattered)).epsilon(2e-3));
}

TEST_CASE("frames of a picture lie around its pixels and over all of the lens") {
  for (const std::uint32_t count : {1u, 2u, 3u, 4u, 8u, 31u, 64u}) {
    CAPTURE(count);
    glm::dvec2 mean(0), lens(0);
    double within = 0;
    std::vector<double> across;
    for (std::uint32_t i = 0; i < count; ++i) {
      const FrameOffset offset = frame_offset({i, count});
      CHECK(std::max(std::abs(offset.pixel.x), std::abs(offset.pixel.y)) < 0.5);
      CHECK(glm::length(offset.lens) < 1);
      mean += offset.pixel / static_cast<double>(count);
      lens += offset.lens / static_cast<double>(count);
      within += glm::length(offset.lens) < std::sqrt(0.5) ? 1.0 / count : 0;
      across.push_back(offset.pixel.x);
    }
    CHECK(glm::length(mean) < 1e-12);
    if (count < 4) continue;
    CHECK(glm::length(lens) < 0.2);
    CHECK(within == doctest::Approx(0.5).epsilon(2.0 / count));  // half of the lens' area
    std::sort(across.begin(), across.end());
    CHECK(std::adjacent_find(across.begin(), across.end()) == across.end());  // no two in one column
  }
  CHECK(frame_offset({0, 1}).lens == glm::dvec2(0));
}

TEST_CASE("the samples of a pixel are taken by fours, and as many as needed where nobody says how many") {
  CHECK(frame_count({}, {.samples = 1}) == 1);
  CHECK(frame_count({}, {.samples = 4}) == 1);
  CHECK(frame_count({}, {.samples = 5}) == 2);
  CHECK(frame_count({}, {}) == 4);
  CHECK(frame_count({.aperture = 1}, {}) == 64);
  LitCube cube;
  CHECK_THROWS_WITH_AS(cube.picture(70000), doctest::Contains("samples: found 70000"), InputError);
}

TEST_CASE("with more samples alpha comes to the covered share of every pixel, and the light of a picture stays") {
  LitCube cube;
  const Picture truth = cube.picture(4096);
  // The shadow of a cube of 2 mm across parallel rays.
  const Camera camera = place_camera(slanted, cube.engine.bounds(), 1);
  const glm::vec3 along = glm::abs(camera.backward);
  const double pixel = 4.5 / side;
  CHECK(total(truth.alpha) == doctest::Approx(4 * (along.x + along.y + along.z) / (pixel * pixel)).epsilon(1e-4));
  double last = 0.015;
  for (const std::uint32_t samples : {4u, 16u, 64u, 256u}) {
    const Picture picture = cube.picture(samples);
    const double error = silhouette_error(picture.alpha, truth.alpha);
    MESSAGE(samples, " samples: ", error, " RMS of alpha along the silhouette");
    CHECK(error < 0.6 * last);
    last = error;
    CHECK(total(picture.alpha) == doctest::Approx(total(truth.alpha)).epsilon(2e-3));
    CHECK(total(picture.scattered) == doctest::Approx(total(truth.scattered)).epsilon(2e-3));
    CHECK(total(picture.specular) == doctest::Approx(total(truth.specular)).epsilon(5e-3));
  }
  CHECK(last < 0.001);
}

TEST_CASE("in one frame alpha is the covered share of a pixel, also where tiles meet and behind the eye") {
  struct Case {
    std::string name;
    View view;
    std::uint32_t wide, high;
  };
  LitCube cube;
  const auto picture = [&](const Case& from, std::uint32_t samples) {
    return cube.engine.render(
        from.view, {.width = from.wide, .height = from.high, .samples = samples, .transmission_roughness = 0.0f});
  };
  View near = slanted;
  near.orthographic.reset();
  const glm::vec3 middle = cube.engine.bounds().centre;
  near.eye = middle + glm::vec3(0.1f, 1.6f, 0.5f);  // over a face that reaches behind it
  near.look_at = middle + glm::vec3(0, 0.8f, -1);
  near.vertical_fov = 100;
  for (const Case& from : {Case{"tiles", slanted, 1100, 1040}, Case{"near", near, 160, 120}}) {
    CAPTURE(from.name);
    const Picture once = picture(from, 4), truth = picture(from, 256);
    const double error = silhouette_error(once.alpha, truth.alpha);
    MESSAGE(from.name, ": ", error, " RMS of alpha along the silhouette");
    CHECK(error < 0.015);
  }
}

TEST_CASE("a pixel that every frame covers is covered, by any number of them") {
  LitCube cube;
  for (const std::uint32_t samples : {4u, 12u, 28u, 64u}) {
    const Picture picture = cube.picture(samples);
    const auto whole = static_cast<double>(std::count(picture.alpha.begin(), picture.alpha.end(), 1.0f));
    CHECK(whole > 0.9 * total(picture.alpha));
    CHECK(*std::max_element(picture.alpha.begin(), picture.alpha.end()) == 1);
    CHECK(*std::min_element(picture.alpha.begin(), picture.alpha.end()) == 0);
  }
}

TEST_CASE("frame by frame a picture becomes what it is at once, and memory does not grow with its samples") {
  LitCube cube;
  const RenderOptions options{.width = side, .height = side, .samples = 32, .ground = true};
  const Picture whole = cube.engine.render(slanted, options);
  const std::uint64_t bytes = cube.engine.device_bytes();
  for (std::uint32_t i = 0; i < frame_count(slanted, options); ++i) {
    const PictureBuffers& mean = cube.engine.draw_frame(slanted, options, i);
    if (i == 0) CHECK(read_picture(cube.engine.device(), mean).scattered != whole.scattered);
    if (i < 7) continue;
    const Picture after = read_picture(cube.engine.device(), mean);
    CHECK(after.scattered == whole.scattered);
    CHECK(after.alpha == whole.alpha);
  }
  cube.picture(512);
  CHECK(cube.engine.device_bytes() == bytes);
}

TEST_CASE("a point out of focus is as large as the circle of confusion of a thin lens") {
  constexpr double aperture = 6, pixels_per_slope = 100 / 0.0874887;  // of half of 10 degrees over half of 200 pixels
  for (const auto& [away, focus] : {std::pair{60.0, 100.0}, std::pair{100.0, 140.0}, std::pair{150.0, 80.0}}) {
    const std::vector<float> alpha = ball_through_lens(static_cast<float>(away), 0.1f, aperture, focus);
    const double circle = 0.5 * aperture * std::abs(1 / focus - 1 / away) * pixels_per_slope;
    const double own = 0.1 / away * pixels_per_slope;
    CHECK(circle > 5);
    CHECK(spread(alpha) == doctest::Approx(std::hypot(circle, own)).epsilon(0.02));
    CHECK(total(alpha) == doctest::Approx(std::numbers::pi * own * own).epsilon(0.05));  // nothing is lost
  }
}

TEST_CASE("what is in focus is as sharp as without a lens") {
  const double sharp = spread(ball_through_lens(100, 1, 0, 100)), seen = spread(ball_through_lens(100, 1, 6, 100));
  CHECK(seen == doctest::Approx(sharp).epsilon(0.002));
  CHECK(spread(ball_through_lens(100, 1, 6, 60)) > 1.5 * sharp);
}

TEST_CASE("a lens is in focus on the nearest of the body unless told otherwise, and parallel rays have none") {
  LitCube cube;
  const View ahead{.azimuth = 0, .elevation = 0, .distance = 20.0f, .vertical_fov = 20, .aperture = 2};
  View said = ahead;
  said.focus = 19.0f;  // the cube's face, 1 mm before its middle
  CHECK(cube.picture(64, ahead).alpha == cube.picture(64, said).alpha);
  said.focus = 25.0f;
  CHECK(cube.picture(64, ahead).alpha != cube.picture(64, said).alpha);
  View parallel = slanted;
  parallel.aperture = 2;
  CHECK_THROWS_WITH_AS(cube.picture(4, parallel), doctest::Contains("aperture: found 2 with orthographic"), InputError);
}
