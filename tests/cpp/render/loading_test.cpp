// How shaders load arrays changes no picture.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/render/engine.h"
#include "engine/vk/arena.h"

using namespace quadgraph;

namespace {

const std::filesystem::path cube = std::filesystem::path(QUADGRAPH_TEST_DATA) / "tiny.qgraph";

struct Lit {
  Engine engine;

  explicit Lit(std::uint64_t bytes) : engine(cube, {.validation = true, .device = "", .texel_bytes = bytes}) {
    CHECK(engine.context().arenas()[0].used() == (bytes > 0));
    engine.set_material("sigma_s_prime=2/1/0.5,sigma_a=0.1,eta=1.3");
    engine.set_lights({parse_light("directional:-0.3,-0.4,-0.86602540:1/2/3"), parse_light("point:4,2,1:20/10/5"),
                       parse_light("ambient:0.2")});
    engine.solve({.tolerance = 1e-5});
  }
  Lit(const Lit&) = delete;
  Lit& operator=(const Lit&) = delete;
  ~Lit() {
    for (const auto& message : engine.context().validation_messages()) FAIL_CHECK(message);
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

std::vector<float> flat(const std::vector<glm::vec3>& values) {
  std::vector<float> result;
  for (const glm::vec3& value : values) result.insert(result.end(), {value.x, value.y, value.z});
  return result;
}

}  // namespace

TEST_CASE("arrays read as texels and arrays read through references give the same picture") {
  Lit texels(1 << 28), references(0);
  for (std::uint32_t level = 0; level < references.engine.graph().levels().size(); ++level) {
    const auto q = [&](Lit& lit) {
      return vk::download<float>(lit.engine.context(), lit.engine.simulation().level(level).q);
    };
    CHECK(difference(q(texels), q(references)) < 1e-6);
  }
  for (const Radiance radiance : {Radiance::gathered, Radiance::lambertian}) {
    CAPTURE(name_of(radiance));
    const View view{.azimuth = 30, .elevation = 20};
    const RenderOptions options{.width = 48, .height = 32, .radiance = radiance};
    const Picture a = texels.engine.render(view, options), b = references.engine.render(view, options);
    CHECK(difference(a.scattered, b.scattered) < 1e-5);
    CHECK(difference(a.specular, b.specular) < 1e-5);
    CHECK(difference(a.unscattered, b.unscattered) < 1e-5);
    if (radiance == Radiance::gathered) CHECK(difference(a.transmittance, b.transmittance) < 1e-5);
    CHECK(a.alpha == b.alpha);
  }
  const std::vector<std::uint32_t> faces = {0, 1, 2, 3};
  const auto normals = references.engine.surface_field().normal;
  const std::vector<glm::vec3> directions(normals.begin(), normals.begin() + 4);
  const Leaving a = texels.engine.leaving(faces, directions), b = references.engine.leaving(faces, directions);
  CHECK(difference(flat(a.radiance), flat(b.radiance)) < 1e-5);
  CHECK(difference(flat(a.transmittance), flat(b.transmittance)) < 1e-5);
}
