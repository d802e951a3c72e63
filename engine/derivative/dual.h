// A number with its derivatives along one direction, or by a few inputs (forward mode; Griewank and Walther 2008,
// chapter 3).
#pragma once

#include <cmath>

namespace quadgraph {

// `Slope`: double, or a vector of derivatives.
template <class Slope>
struct DualOf {
  double value = 0;
  Slope slope = Slope(0);

  DualOf() = default;
  explicit DualOf(double constant) : value(constant) {}
  DualOf(double at, const Slope& derivative) : value(at), slope(derivative) {}
};

using Dual = DualOf<double>;

template <class Slope>
double value_of(const DualOf<Slope>& a) {
  return a.value;
}

template <class Slope>
DualOf<Slope> operator-(const DualOf<Slope>& a) {
  return {-a.value, -a.slope};
}
template <class Slope>
DualOf<Slope> operator+(const DualOf<Slope>& a, const DualOf<Slope>& b) {
  return {a.value + b.value, a.slope + b.slope};
}
template <class Slope>
DualOf<Slope> operator+(const DualOf<Slope>& a, double b) {
  return {a.value + b, a.slope};
}
template <class Slope>
DualOf<Slope> operator-(const DualOf<Slope>& a, const DualOf<Slope>& b) {
  return {a.value - b.value, a.slope - b.slope};
}
template <class Slope>
DualOf<Slope> operator-(double a, const DualOf<Slope>& b) {
  return {a - b.value, -b.slope};
}
template <class Slope>
DualOf<Slope> operator*(const DualOf<Slope>& a, const DualOf<Slope>& b) {
  return {a.value * b.value, a.slope * b.value + b.slope * a.value};
}
template <class Slope>
DualOf<Slope> operator*(const DualOf<Slope>& a, double b) {
  return {a.value * b, a.slope * b};
}
template <class Slope>
DualOf<Slope> operator*(double a, const DualOf<Slope>& b) {
  return b * a;
}
template <class Slope>
DualOf<Slope> operator/(const DualOf<Slope>& a, const DualOf<Slope>& b) {
  const double value = a.value / b.value;
  return {value, (a.slope - b.slope * value) / b.value};
}
template <class Slope>
DualOf<Slope> operator/(const DualOf<Slope>& a, double b) {
  return {a.value / b, a.slope / b};
}

template <class Slope>
DualOf<Slope> exp(const DualOf<Slope>& a) {
  const double value = std::exp(a.value);
  return {value, a.slope * value};
}
template <class Slope>
DualOf<Slope> expm1(const DualOf<Slope>& a) {
  return {std::expm1(a.value), a.slope * std::exp(a.value)};
}
template <class Slope>
DualOf<Slope> log(const DualOf<Slope>& a) {
  return {std::log(a.value), a.slope / a.value};
}

// As of engine/reference/exitance.h and block.h.
template <class Slope>
DualOf<Slope> positive(const DualOf<Slope>& a) {
  return a.value > 0 ? a : DualOf<Slope>();
}
template <class Slope>
DualOf<Slope> safe_ratio(const DualOf<Slope>& a, const DualOf<Slope>& b) {
  return b.value > 0 ? a / b : DualOf<Slope>();
}

}  // namespace quadgraph
