// What a body is made of, as kernels read it that are written once for all numbers: double, or one that carries
// derivatives (engine/derivative/).
#pragma once

#include <cstdint>
#include <span>

#include "shaders/shared/shared.h"

namespace quadgraph {

inline double value_of(double number) {
  return number;
}

// Of one tet and channel, 1/mm.
template <class Real>
struct Coefficients {
  Real scattering, absorption;

  Real extinction() const { return scattering + absorption; }
  // Share of what is taken out of light that scatters; 0 where nothing is.
  Real albedo() const {
    const Real sigma_t = extinction();
    return value_of(sigma_t) > 0 ? scattering / sigma_t : Real(0);
  }
};

// The coefficients of a problem.
class Medium {
 public:
  using Real = double;

  explicit Medium(std::span<const gpu::Optical> optical) : optical_(optical) {}

  Coefficients<double> at(std::uint32_t tet, int channel) const {
    const gpu::Optical& optical = optical_[tet];
    return {double{optical.sigma_s_prime[channel]}, double{optical.sigma_a[channel]}};
  }

 private:
  std::span<const gpu::Optical> optical_;
};

}  // namespace quadgraph
