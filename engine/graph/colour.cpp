#include "engine/graph/colour.h"

#include <string>

#include "engine/graph/error.h"
#include "engine/graph/fresnel.h"
#include "engine/graph/resolution.h"

namespace quadgraph {

double diffuse_reflectance(double albedo, double eta) {
  constexpr double any_depth = 1;
  return fresnel_transmittance(1, eta) * layered_half_space(albedo, eta, any_depth, Model::sp3).exact;
}

double albedo_of(double reflectance, double eta) {
  const double most = diffuse_reflectance(1, eta);
  if (!(reflectance >= 0 && reflectance < most)) {
    throw InputError("material field 'reflectance': found '" + std::to_string(reflectance) + "', allowed is 0 to " +
                     std::to_string(most) + ", which nothing that does not shine exceeds at this eta");
  }
  // Reflectance rises with albedo. Where it is steep, near 1, halves of an interval in 1 - albedo lose no digits.
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double absorbed = (low + high) / 2;
    (diffuse_reflectance(1 - absorbed, eta) < reflectance ? high : low) = absorbed;
  }
  return 1 - (low + high) / 2;
}

}  // namespace quadgraph
