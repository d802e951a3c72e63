// The processor draws the picture of a Vulkan device.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/render/engine.h"
#include "tests/cpp/fixtures/device_work.h"
#include "tests/cpp/fixtures/test_data.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

namespace {

const std::filesystem::path cube = test_data("tiny.qgraph");

struct LitEngine {
  Engine engine;

  explicit LitEngine(const device::DeviceOptions& device) : engine(cube, device) {
    engine.set_material("sigma_s_prime=2/1/0.5,sigma_a=0.1,eta=1.3");
    // Off the planes of the cube's tets: which of two a ray is in that runs along their face, a last bit decides.
    engine.set_lights({parse_light("directional:-0.3,-0.4,-0.86602540:1/2/3"), parse_light("point:4.1,2.3,1.2:20/10/5"),
                       parse_light("ambient:0.2")});
    engine.solve({.tolerance = 1e-5});
  }
  LitEngine(const LitEngine&) = delete;
  LitEngine& operator=(const LitEngine&) = delete;
  ~LitEngine() {
    for (const auto& message : engine.device().validation_messages()) FAIL_CHECK(message);
  }
};

// Largest difference over the largest value.
double difference(const std::vector<float>& values, const std::vector<float>& expected) {
  REQUIRE(values.size() == expected.size());
  double largest = 0, apart = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    largest = std::max(largest, std::abs(double{expected[i]}));
    apart = std::max(apart, std::abs(double{values[i]} - double{expected[i]}));
  }
  REQUIRE(largest > 0);
  return apart / largest;
}

// Corners in the window are rounded to 1/256 of a pixel, and interpolated places may be that far apart. Where that puts
// one of the four samples of a pixel across the edge of a shadow or of a triangle, the pixel differs by more.
void check_alike(const std::vector<float>& values, const std::vector<float>& expected) {
  CHECK(difference(values, expected) < 5e-3);
  const double largest = *std::max_element(expected.begin(), expected.end());
  std::size_t apart = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(double{values[i]} - double{expected[i]}) > 1e-4 * largest) ++apart;
  }
  CHECK(apart < values.size() / 1000);
}

}  // namespace

TEST_CASE("light, pictures and leaving radiance are the same on both") {
  LitEngine here({.device = "cpu"}), there(test_vulkan_device());
  for (std::uint32_t level = 0; level < there.engine.graph().levels().size(); ++level) {
    const auto q = [&](LitEngine& lit) {
      return device::download<float>(lit.engine.device(), lit.engine.simulation().level(level).q);
    };
    CHECK(difference(q(here), q(there)) < 1e-6);
  }
  for (const Radiance radiance : {Radiance::gathered, Radiance::lambertian}) {
    CAPTURE(name_of(radiance));
    const View view{.azimuth = 30, .elevation = 20};
    const RenderOptions options{.width = 384, .height = 256, .samples = 4, .radiance = radiance};
    const Picture a = here.engine.render(view, options), b = there.engine.render(view, options);
    check_alike(a.scattered, b.scattered);
    check_alike(a.specular, b.specular);
    check_alike(a.unscattered, b.unscattered);
    if (radiance == Radiance::gathered) check_alike(a.transmittance, b.transmittance);
    CHECK(a.alpha == b.alpha);
  }
  const std::vector<std::uint32_t> faces = {0, 1, 2, 3};
  const auto normals = there.engine.surface_field().normal;
  const std::vector<glm::vec3> directions(normals.begin(), normals.begin() + 4);
  const Leaving a = here.engine.leaving(faces, directions), b = there.engine.leaving(faces, directions);
  CHECK(difference(flat(a.radiance), flat(b.radiance)) < 1e-5);
  CHECK(difference(flat(a.transmittance), flat(b.transmittance)) < 1e-5);
}
