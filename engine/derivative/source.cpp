#include "engine/derivative/source.h"

#include <array>
#include <cstdint>

#include "engine/derivative/media.h"
#include "engine/reference/beam.h"

namespace quadgraph {
namespace {

// One of the lights, as its quarters and power say.
template <class Numbers>
class GivenLight {
 public:
  using Power = std::array<typename Numbers::Real, 3>;

  GivenLight(const Numbers& numbers, std::span<const Quarters> quarters, std::size_t number)
      : numbers_(numbers), light_(quarters), number_(number) {}

  Power of(std::uint32_t f, std::uint32_t quarter, double area) const {
    const std::array<double, 3> watt = light_.of(f, quarter, area);
    Power power{};
    for (std::size_t c = 0; c < 3; ++c) {
      if (watt[c] > 0) power[c] = numbers_.power(number_, static_cast<int>(c)) * watt[c];
    }
    return power;
  }

 private:
  const Numbers& numbers_;
  QuarterLight light_;
  std::size_t number_;
};

// What enters again.
template <class Real>
class AgainLight {
 public:
  explicit AgainLight(std::span<const glm::dvec3> q) : q_(q) {}

  std::array<Real, 3> of(std::uint32_t f, std::uint32_t, double area) const {
    return {Real(q_[f][0] * area), Real(q_[f][1] * area), Real(q_[f][2] * area)};
  }

 private:
  std::span<const glm::dvec3> q_;
};

// Adds up values or slopes.
class Sum {
 public:
  explicit Sum(Walked& sum) : sum_(sum) {}

  template <class Real>
  void scattered(std::uint32_t vertex, int c, const Real& watt) {
    sum_.scattered[vertex][c] += part(watt);
  }
  template <class Real>
  void unscattered(std::uint32_t f, int c, const Real& watt) {
    sum_.unscattered[f][c] += part(watt);
  }
  template <class Real>
  void entered(int, const Real&) {}
  template <class Real>
  void absorbed(int, const Real&) {}
  template <class Real>
  void trapped(int, const Real&) {}

 private:
  static double part(double watt) { return watt; }
  static double part(const Dual& watt) { return watt.slope; }

  Walked& sum_;
};

// Weighs what is left on the active tape.
class Weigh {
 public:
  explicit Weigh(const Walked& weights) : weights_(weights) {}

  void scattered(std::uint32_t vertex, int c, const Traced& watt) {
    Tape::active().weigh(watt, weights_.scattered[vertex][c]);
  }
  void unscattered(std::uint32_t f, int c, const Traced& watt) {
    Tape::active().weigh(watt, weights_.unscattered[f][c]);
  }
  void entered(int, const Traced&) {}
  void absorbed(int, const Traced&) {}
  void trapped(int, const Traced&) {}

 private:
  const Walked& weights_;
};

// `after` is called after every face of a light.
template <class Numbers, class Sink, class After>
void walk_all(const Level& level, const Problem& problem, const Numbers& numbers, const Entering& light, Sink& sink,
              const After& after) {
  const auto enter = [&](auto& beam, auto&& quarters) {
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      if (level.reflecting(f)) continue;
      beam.enter(f, quarters(f));
      after();
      if (light.check) light.check();
    }
  };
  for (std::size_t i = 0; i < light.lights.size(); ++i) {
    GivenLight given(numbers, light.lights[i].quarters, i);
    Beam beam(level, problem, numbers, light.lights[i].beam, given, sink, differentiable_end);
    enter(beam, [&](std::uint32_t f) { return light.lights[i].quarters[f]; });
  }
  if (light.again.empty()) return;
  const gpu::BeamRecord mean{gpu::BEAM_MEAN, {}, {}, {}};
  AgainLight<typename Numbers::Real> again(light.again);
  Beam beam(level, problem, numbers, mean, again, sink, differentiable_end);
  enter(beam, [](std::uint32_t) { return Quarters{}; });
}

}  // namespace

Walked walk(const Level& level, const Problem& problem, const Parameters& at, const Entering& light) {
  Walked result(level);
  Sum sum(result);
  walk_all(level, problem, PlainNumbers(at), light, sum, [] {});
  return result;
}

Walked walk_tangent(const Level& level, const Problem& problem, const Parameters& at, const Parameters& along,
                    const Entering& light) {
  Walked result(level);
  Sum sum(result);
  walk_all(level, problem, DualNumbers(at, along), light, sum, [] {});
  return result;
}

void walk_adjoint(const Level& level, const Problem& problem, const Parameters& at, const Walked& weights,
                  const Entering& light, Parameters& gradient) {
  Tape tape;
  const Tape::Recording recording(tape);
  Weigh weigh(weights);
  walk_all(level, problem, TracedNumbers(at, gradient), light, weigh, [&] {
    tape.back();
    tape.clear();
  });
}

}  // namespace quadgraph
