// A number with its derivative along one direction (forward mode; Griewank and Walther 2008, chapter 3).
#pragma once

#include <cmath>

namespace quadgraph {

struct Dual {
  double value = 0, slope = 0;

  Dual() = default;
  explicit Dual(double constant) : value(constant) {}
  Dual(double at, double derivative) : value(at), slope(derivative) {}
};

inline double value_of(const Dual& a) {
  return a.value;
}

inline Dual operator-(const Dual& a) {
  return {-a.value, -a.slope};
}
inline Dual operator+(const Dual& a, const Dual& b) {
  return {a.value + b.value, a.slope + b.slope};
}
inline Dual operator+(const Dual& a, double b) {
  return {a.value + b, a.slope};
}
inline Dual operator-(const Dual& a, const Dual& b) {
  return {a.value - b.value, a.slope - b.slope};
}
inline Dual operator-(double a, const Dual& b) {
  return {a - b.value, -b.slope};
}
inline Dual operator*(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.slope * b.value + a.value * b.slope};
}
inline Dual operator*(const Dual& a, double b) {
  return {a.value * b, a.slope * b};
}
inline Dual operator*(double a, const Dual& b) {
  return b * a;
}
inline Dual operator/(const Dual& a, const Dual& b) {
  const double value = a.value / b.value;
  return {value, (a.slope - value * b.slope) / b.value};
}
inline Dual operator/(const Dual& a, double b) {
  return {a.value / b, a.slope / b};
}

inline Dual exp(const Dual& a) {
  const double value = std::exp(a.value);
  return {value, a.slope * value};
}
inline Dual expm1(const Dual& a) {
  return {std::expm1(a.value), a.slope * std::exp(a.value)};
}
inline Dual log(const Dual& a) {
  return {std::log(a.value), a.slope / a.value};
}

// As of engine/reference/exitance.h and block.h.
inline Dual positive(const Dual& a) {
  return a.value > 0 ? a : Dual();
}
inline Dual safe_ratio(const Dual& a, const Dual& b) {
  return b.value > 0 ? a / b : Dual();
}

}  // namespace quadgraph
