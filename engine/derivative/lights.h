// Light at the faces as numbers with derivatives; what Beam and Follower of the reference read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "engine/derivative/media.h"
#include "engine/reference/source_walk.h"

namespace quadgraph {

// One of the lights, as its quarters and power say.
template <class Numbers>
class GivenLight {
 public:
  GivenLight(const Numbers& numbers, std::span<const Quarters> quarters, std::size_t number)
      : numbers_(numbers), light_(quarters), number_(number) {}

  std::array<typename Numbers::Real, 3> at(std::uint32_t f, std::uint32_t quarter) const {
    const std::array<double, 3> q = light_.at(f, quarter);
    std::array<typename Numbers::Real, 3> value{};
    for (std::size_t c = 0; c < 3; ++c) {
      if (q[c] > 0) value[c] = numbers_.power(number_, static_cast<int>(c)) * q[c];
    }
    return value;
  }

 private:
  const Numbers& numbers_;
  QuarterLight light_;
  std::size_t number_;
};

// What enters again, which stays.
template <class Real>
struct AgainLight {
  std::span<const glm::dvec3> q;

  std::array<Real, 3> at(std::uint32_t f, std::uint32_t) const { return {Real(q[f][0]), Real(q[f][1]), Real(q[f][2])}; }
};

// The same as inputs of the active tape, whose rows are recorded.
struct TracedAgainLight {
  std::span<const glm::dvec3> q;
  RecordedInputs by;

  std::array<Traced, 3> at(std::uint32_t f, std::uint32_t) const {
    Tape& tape = Tape::active();
    return {tape.input(q[f][0], by[f][0]), tape.input(q[f][1], by[f][1]), tape.input(q[f][2], by[f][2])};
  }
};

}  // namespace quadgraph
