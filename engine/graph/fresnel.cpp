#include "engine/graph/fresnel.h"

#include <cmath>

namespace quadgraph {

double fresnel_transmittance(double cos_i, double eta) {
  if (eta == 1.0) return 1.0;  // the quotients below are 0/0 at grazing incidence
  const double cos_t = std::sqrt(1.0 - (1.0 - cos_i * cos_i) / (eta * eta));
  const double parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const double perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return 1.0 - 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

double internal_diffuse_reflectance(double eta) {
  if (eta <= 1.0) return 0.0;
  return -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
}

double mismatch(double eta) {
  const double f_dr = internal_diffuse_reflectance(eta);
  return (1.0 + f_dr) / (1.0 - f_dr);
}

}  // namespace quadgraph
