// Parameters as the kernels of the reference read them (engine/reference/medium.h), by kind of number.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "engine/derivative/dual.h"
#include "engine/derivative/parameters.h"
#include "engine/derivative/traced.h"
#include "engine/reference/medium.h"

namespace quadgraph {

// As they are.
class PlainNumbers {
 public:
  using Real = double;

  explicit PlainNumbers(const Parameters& at) : at_(at) {}

  Coefficients<double> at(std::uint32_t tet, int c) const { return {at_.scattering[tet][c], at_.absorption[tet][c]}; }
  double power(std::size_t light, int c) const { return at_.power[light][c]; }

 private:
  const Parameters& at_;
};

// With derivatives along a direction.
class DualNumbers {
 public:
  using Real = Dual;

  DualNumbers(const Parameters& at, const Parameters& along) : at_(at), along_(along) {}

  Coefficients<Dual> at(std::uint32_t tet, int c) const {
    return {{at_.scattering[tet][c], along_.scattering[tet][c]}, {at_.absorption[tet][c], along_.absorption[tet][c]}};
  }
  Dual power(std::size_t light, int c) const { return {at_.power[light][c], along_.power[light][c]}; }

 private:
  const Parameters& at_;
  const Parameters& along_;
};

// As inputs of the active tape, whose derivatives are added to a gradient.
class TracedNumbers {
 public:
  using Real = Traced;

  TracedNumbers(const Parameters& at, Parameters& gradient) : at_(at), gradient_(gradient) {}

  Coefficients<Traced> at(std::uint32_t tet, int c) const {
    return {input(at_.scattering[tet][c], gradient_.scattering[tet][c]),
            input(at_.absorption[tet][c], gradient_.absorption[tet][c])};
  }
  Traced power(std::size_t light, int c) const { return input(at_.power[light][c], gradient_.power[light][c]); }

 private:
  static Traced input(double value, double& derivative) { return Tape::active().input(value, derivative); }

  const Parameters& at_;
  Parameters& gradient_;
};

}  // namespace quadgraph
