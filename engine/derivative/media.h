// Parameters as the kernels of the reference read them (engine/reference/medium.h), by kind of number.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "engine/derivative/dual.h"
#include "engine/derivative/parameters.h"
#include "engine/derivative/sparse_rows.h"
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

// With derivatives by what the present step of a ray depends on: sigma_s' and sigma_a of its tet, and the power that
// comes to it, which is at first that of its light.
class StepNumbers {
 public:
  using Real = DualOf<glm::dvec3>;

  explicit StepNumbers(const Parameters& at) : at_(at) {}

  Coefficients<Real> at(std::uint32_t tet, int c) const {
    return {{at_.scattering[tet][c], {1, 0, 0}}, {at_.absorption[tet][c], {0, 1, 0}}};
  }
  Real power(std::size_t light, int c) const { return {at_.power[light][c], {0, 0, 1}}; }

 private:
  const Parameters& at_;
};

// What numbers of a tape are recorded by, like Parameters.
struct RecordedParameters {
  RecordedInputs scattering, absorption, power;
};

// As inputs of the active tape, whose derivatives are recorded.
class TracedNumbers {
 public:
  using Real = Traced;

  TracedNumbers(const Parameters& at, const RecordedParameters& by) : at_(at), by_(by) {}

  Coefficients<Traced> at(std::uint32_t tet, int c) const {
    return {input(at_.scattering[tet][c], by_.scattering[tet][c]),
            input(at_.absorption[tet][c], by_.absorption[tet][c])};
  }
  Traced power(std::size_t light, int c) const { return input(at_.power[light][c], by_.power[light][c]); }

 private:
  static Traced input(double value, double& derivative) { return Tape::active().input(value, derivative); }

  const Parameters& at_;
  const RecordedParameters& by_;
};

}  // namespace quadgraph
