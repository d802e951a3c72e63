// The exitance of a coarse surface, made even.
#include "engine/reference/even_exitance.h"

#include <doctest/doctest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>

#include "engine/reference/entering.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"

using namespace quadgraph;

namespace {

// A ball lit from above whose exitance is a share of what enters, and scatters by 5% from face to face.
struct Scattered {
  OwnedLevel owned = ball_level(8, 10.0);
  Level level = owned.view();
  std::vector<gpu::Optical> optical;
  std::vector<glm::dvec3> q, smooth, exitance;

  explicit Scattered(float sigma_s_prime) {
    optical.assign(level.nodes.size(), {glm::vec3(sigma_s_prime), glm::vec3(0.001f)});
    std::mt19937 random(7);
    std::normal_distribution<double> by(0, 0.05);
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      q.emplace_back(std::max(frame_of(level, f).normal.y, 0.0));
      smooth.push_back(0.9 * q.back());
      exitance.push_back(smooth.back() * (1 + by(random)));
    }
  }

  void run() { make_even(level, {Method::fem, Source::buried, Model::sp3, optical, 1.3}, q, exitance); }

  double off() const {
    double sum = 0, size = 0;
    for (std::size_t f = 0; f < exitance.size(); ++f) {
      sum += std::pow(exitance[f].x - smooth[f].x, 2);
      size += smooth[f].x * smooth[f].x;
    }
    return std::sqrt(sum / size);
  }

  double power() const {
    double sum = 0;
    for (std::uint32_t f = 0; f < level.face_count(); ++f) sum += frame_of(level, f).area * exitance[f].x;
    return sum;
  }
};

}  // namespace

TEST_CASE("what scatters from face to face of a coarse surface is made even, and the power stays") {
  Scattered dense(20.0f);
  const double before = dense.off(), power = dense.power();
  dense.run();
  CHECK(dense.off() < 0.6 * before);
  CHECK(dense.power() == doctest::Approx(power).epsilon(1e-9));
  for (const glm::dvec3& m : dense.exitance) CHECK(m.x >= 0);
}

TEST_CASE("a surface that resolves the mean free path stays as it is") {
  Scattered thin(0.5f);
  const std::vector<glm::dvec3> before = thin.exitance;
  thin.run();
  CHECK(thin.exitance == before);
}
