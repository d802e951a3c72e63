#include "engine/optics/boundary.h"

#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

#include "engine/optics/fresnel.h"
#include "engine/optics/surface_boundary.h"

namespace quadgraph {
namespace {

// K of (phi1, phi2), before it is made symmetric.
glm::dmat2 klose_larsen(const OpticalSurface& surface) {
  const auto r = [&](int n) { return fresnel_moment(n, surface); };
  const double a1 = -r(1), b1 = 3 * r(2);
  const double a2 = -9.0 / 4 * r(1) + 15.0 / 2 * r(3) - 25.0 / 4 * r(5);
  const double b2 = 63.0 / 4 * r(2) - 105.0 / 2 * r(4) + 175.0 / 4 * r(6);
  const double c = -3.0 / 2 * r(1) + 5.0 / 2 * r(3);
  const double d = 3.0 / 2 * r(2) - 5.0 / 2 * r(4);
  // glm::dmat2 takes columns.
  const glm::dmat2 flux(1 + b1, -3 * d, -7 * d, 1 + b2);
  const glm::dmat2 fields(0.5 + a1, -(1.0 / 8 + c), -(1.0 / 8 + c), 7.0 / 24 + a2);
  return glm::inverse(flux) * fields;
}

Boundary sp3(const OpticalSurface& surface) {
  const glm::dmat2 k = klose_larsen(surface);
  const glm::dmat2 symmetric = 0.5 * (k + glm::transpose(k));
  const glm::dmat2 phi1_from_phi(1, 0, 2.0 / 3, 1);  // phi1 = phi + 2/3 phi2
  const glm::dmat2 result = glm::transpose(phi1_from_phi) * symmetric * phi1_from_phi;
  return {.k11 = result[0][0], .k12 = result[1][0], .k22 = result[1][1]};
}

}  // namespace

Boundary boundary_of(Method method, Source source, Model model, const OpticalSurface& surface) {
  const bool as_published = published(method) && source == Source::diffuse && model == Model::diffusion;
  Boundary boundary;
  double f_dr = 2 * fresnel_moment(1, surface);
  if (as_published) {
    f_dr = internal_diffuse_reflectance(surface.eta);
    boundary.k11 = 1 / (2 * mismatch(surface.eta));
  } else if (model == Model::diffusion) {
    boundary.k11 = (1 - f_dr) / (2 * (1 + 3 * fresnel_moment(2, surface)));
  } else {
    boundary = sp3(surface);
  }
  if (source == Source::diffuse) {
    boundary.source = 4 / (1 - f_dr);
    boundary.reflected = boundary.k11 * boundary.source - 1;
  }
  return boundary;
}

}  // namespace quadgraph
