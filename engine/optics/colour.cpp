#include "engine/optics/colour.h"

#include <optional>
#include <utility>

#include "engine/optics/fresnel.h"
#include "engine/optics/half_space.h"

namespace quadgraph {
namespace {

// A boundary takes far longer to find than what a half-space behind it reflects.
class HalfSpace {
 public:
  explicit HalfSpace(double eta)
      : enters_(fresnel_transmittance(1, eta)), boundary_(boundary_of(Method::fem, Source::buried, Model::sp3, eta)) {}

  double reflectance(double albedo) const {
    constexpr double any_depth = 1;
    return enters_ * layered_half_space(albedo, boundary_, any_depth, Model::sp3).exact;
  }

 private:
  double enters_;
  Boundary boundary_;
};

// The one asked for last is kept: all colours of a scene that is read again and again are at one index.
const HalfSpace& half_space_of(double eta) {
  thread_local std::optional<std::pair<double, HalfSpace>> last;
  if (!last || last->first != eta) last.emplace(eta, HalfSpace(eta));
  return last->second;
}

}  // namespace

double diffuse_reflectance(double albedo, double eta) {
  return half_space_of(eta).reflectance(albedo);
}

double albedo_of(double reflectance, double eta) {
  const HalfSpace& half_space = half_space_of(eta);
  // Reflectance rises with albedo. Where it is steep, near 1, halves of an interval in 1 - albedo lose no digits.
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double absorbed = (low + high) / 2;
    (half_space.reflectance(1 - absorbed) < reflectance ? high : low) = absorbed;
  }
  return 1 - (low + high) / 2;
}

}  // namespace quadgraph
