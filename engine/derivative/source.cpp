#include "engine/derivative/source.h"

#include <cstdint>

#include "engine/derivative/lights.h"
#include "engine/reference/beam.h"

namespace quadgraph {
namespace {

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
    const GivenLight given(numbers, light.lights[i].quarters, i);
    Beam beam(level, problem, numbers, light.lights[i].beam, given, sink, differentiable_end);
    enter(beam, [&](std::uint32_t f) { return light.lights[i].quarters[f]; });
  }
  if (light.again.empty()) return;
  const gpu::BeamRecord mean{gpu::BEAM_MEAN, {}, {}, {}};
  const AgainLight<typename Numbers::Real> again{light.again};
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
