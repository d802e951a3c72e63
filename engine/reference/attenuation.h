// Integrals of e^-tau along a segment, for any number of medium.h.
#pragma once

#include <cmath>

#include "engine/reference/medium.h"

namespace quadgraph {

// Shares of a segment of optical length tau >= 0: what is taken out of a ray, and its first moment along the segment.
template <class Real>
struct Taken {
  Real whole;   // 1 - e^-tau
  Real moment;  // integral of tau e^(-tau s) s over s in [0, 1]
};

template <class Real>
Taken<Real> taken(const Real& tau) {
  using std::exp, std::expm1;
  const Real whole = -expm1(-tau);
  // The closed form loses digits below; four terms of the series are exact to 1e-12 there.
  if (value_of(tau) < 1e-3) return {whole, tau * (0.5 - tau * (1.0 / 3 - tau * (1.0 / 8 - tau * (1.0 / 30))))};
  return {whole, whole / tau - exp(-tau)};
}

// Integral of e^(-x s) (a + (b - a) s) over s from 0 to 1, x >= 0.
template <class Real>
Real weighted(const Real& a, const Real& b, const Real& x) {
  using std::exp, std::expm1;
  if (value_of(x) < 1e-3) {  // the closed forms lose digits; the series is exact to 1e-14
    const Real whole = 1.0 - x * (0.5 - x * (1.0 / 6 - x * (1.0 / 24 - x * (1.0 / 120))));
    const Real moment = 0.5 - x * (1.0 / 3 - x * (1.0 / 8 - x * (1.0 / 30 - x * (1.0 / 144))));
    return a * whole + (b - a) * moment;
  }
  const Real whole = -expm1(-x) / x;
  return a * whole + (b - a) * ((whole - exp(-x)) / x);
}

}  // namespace quadgraph
