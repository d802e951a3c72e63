#include "engine/optics/colour.h"

#include "engine/optics/fresnel.h"
#include "engine/optics/half_space.h"

namespace quadgraph {

double diffuse_reflectance(double albedo, double eta) {
  constexpr double any_depth = 1;
  return fresnel_transmittance(1, eta) * layered_half_space(albedo, eta, any_depth, Model::sp3).exact;
}

double albedo_of(double reflectance, double eta) {
  // Reflectance rises with albedo. Where it is steep, near 1, halves of an interval in 1 - albedo lose no digits.
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double absorbed = (low + high) / 2;
    (diffuse_reflectance(1 - absorbed, eta) < reflectance ? high : low) = absorbed;
  }
  return 1 - (low + high) / 2;
}

}  // namespace quadgraph
