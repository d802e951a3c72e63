// The integral of e^-tau along a segment, for any number of medium.h.
#pragma once

#include <cmath>

#include "engine/reference/medium.h"

namespace quadgraph {

// Integral of e^(-x s) (a + (b - a) s) over s from 0 to 1, x >= 0; a and b are of the same numbers, or double.
template <class Value, class Real>
Real weighted(const Value& a, const Value& b, const Real& x) {
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
