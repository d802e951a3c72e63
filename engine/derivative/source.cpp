#include "engine/derivative/source.h"

#include <array>
#include <cstdint>
#include <optional>

#include "engine/derivative/lights.h"
#include "engine/reference/beam.h"

namespace quadgraph {
namespace {

// Adds up.
class Sum {
 public:
  explicit Sum(Walked& sum) : sum_(sum) {}

  void begins(const std::array<double, 3>&) {}
  void steps(std::uint32_t, const std::array<double, 3>&) {}
  void scattered(std::uint32_t vertex, int c, double watt) { sum_.scattered[vertex][c] += watt; }
  void unscattered(std::uint32_t f, int c, double watt) { sum_.unscattered[f][c] += watt; }
  void entered(int, double) {}
  void absorbed(int, double) {}
  void trapped(int, double) {}

 private:
  Walked& sum_;
};

// `begin` is called with the number of each light, and without one before light that enters again.
template <class Numbers, class Sink, class Begin>
void walk_all(const Level& level, const Problem& problem, const Numbers& numbers, const Entering& light, Sink& sink,
              const Begin& begin) {
  const auto enter = [&](auto& beam, auto&& quarters) {
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      if (level.reflecting(f)) continue;
      beam.enter(f, quarters(f));
      if (light.check) light.check();
    }
  };
  for (std::size_t i = 0; i < light.lights.size(); ++i) {
    begin(static_cast<std::uint32_t>(i));
    const GivenLight given(numbers, light.lights[i].quarters, i);
    Beam beam(level, problem, numbers, light.lights[i].beam, given, sink, differentiable_end);
    enter(beam, [&](std::uint32_t f) { return light.lights[i].quarters[f]; });
  }
  if (light.again.empty()) return;
  begin(std::nullopt);
  const gpu::BeamRecord mean{gpu::BEAM_MEAN, {}, {}, {}};
  const AgainLight<typename Numbers::Real> again{light.again};
  Beam beam(level, problem, numbers, mean, again, sink, differentiable_end);
  enter(beam, [](std::uint32_t) { return Quarters{}; });
}

}  // namespace

// Keeps what each step leaves as its derivatives, by channel.
class StepRecorder {
 public:
  using Real = StepNumbers::Real;
  using Derivative = WalkedRays::Derivative;

  explicit StepRecorder(WalkedRays& rays) : rays_(rays) {}

  void begin_light(std::optional<std::uint32_t> number) { light_ = number.value_or(WalkedRays::none); }

  void begins(const std::array<Real, 3>& power) {
    first_ = true;
    const glm::dvec3 by_power(power[0].slope.z, power[1].slope.z, power[2].slope.z);
    rays_.rays_.push_back({light_, rays_.steps_.size(), by_power});
  }

  // The power is an input of what follows.
  void steps(std::uint32_t tet, std::array<Real, 3>& power) {
    if (!first_) {
      for (int c = 0; c < 3; ++c) put(power[static_cast<std::size_t>(c)], c, rays_.steps_.back().passed);
    }
    first_ = false;
    for (Real& channel : power) channel.slope = {0, 0, 1};
    rays_.steps_.push_back({tet, rays_.deposits_.size(), {}});
  }

  void scattered(std::uint32_t vertex, int c, const Real& watt) { leave(vertex, c, watt); }
  void unscattered(std::uint32_t f, int c, const Real& watt) { leave(rays_.vertices_ + f, c, watt); }
  void entered(int, const Real&) {}
  void absorbed(int, const Real&) {}
  void trapped(int, const Real&) {}

 private:
  static void put(const Real& number, int c, Derivative& by) {
    by.by_scattering[c] += number.slope.x;
    by.by_absorption[c] += number.slope.y;
    by.by_power[c] += number.slope.z;
  }

  void leave(std::uint32_t to, int c, const Real& watt) {
    auto& deposits = rays_.deposits_;
    std::size_t i = rays_.steps_.back().first_deposit;
    while (i < deposits.size() && deposits[i].to != to) ++i;
    if (i == deposits.size()) deposits.push_back({to, {}});
    put(watt, c, deposits[i].by);
  }

  WalkedRays& rays_;
  std::uint32_t light_ = WalkedRays::none;
  bool first_ = true;
};

Walked walk(const Level& level, const Problem& problem, const Parameters& at, const Entering& light) {
  Walked result(level);
  Sum sum(result);
  walk_all(level, problem, PlainNumbers(at), light, sum, [](std::optional<std::uint32_t>) {});
  return result;
}

WalkedRays::WalkedRays(const Level& level, const Problem& problem, const Parameters& at, const Entering& light)
    : vertices_(level.vertex_count()) {
  StepRecorder recorder(*this);
  walk_all(level, problem, StepNumbers(at), light, recorder,
           [&](std::optional<std::uint32_t> number) { recorder.begin_light(number); });
}

Walked WalkedRays::tangent(const Level& level, const Parameters& along) const {
  Walked result(level);
  for (std::size_t r = 0; r < rays_.size(); ++r) {
    const WalkedRay& ray = rays_[r];
    glm::dvec3 power = ray.light == none ? glm::dvec3(0) : ray.by_power * along.power[ray.light];
    for (std::size_t s = ray.first_step; s < end_of_steps(r); ++s) {
      const Step& step = steps_[s];
      const glm::dvec3 &scattering = along.scattering[step.tet], &absorption = along.absorption[step.tet];
      const auto change = [&](const Derivative& by) {
        return by.by_scattering * scattering + by.by_absorption * absorption + by.by_power * power;
      };
      for (std::size_t i = step.first_deposit; i < end_of_deposits(s); ++i) {
        const std::uint32_t to = deposits_[i].to;
        (to < vertices_ ? result.scattered[to] : result.unscattered[to - vertices_]) += change(deposits_[i].by);
      }
      power = change(step.passed);
    }
  }
  return result;
}

void WalkedRays::adjoint(const Walked& weights, Parameters& gradient) const {
  for (std::size_t r = 0; r < rays_.size(); ++r) {
    const WalkedRay& ray = rays_[r];
    glm::dvec3 by_power(0);
    for (std::size_t s = end_of_steps(r); s-- > ray.first_step;) {
      const Step& step = steps_[s];
      Derivative sum;
      const auto add = [&](const Derivative& by, const glm::dvec3& weight) {
        sum.by_scattering += by.by_scattering * weight;
        sum.by_absorption += by.by_absorption * weight;
        sum.by_power += by.by_power * weight;
      };
      add(step.passed, by_power);
      for (std::size_t i = step.first_deposit; i < end_of_deposits(s); ++i) {
        const std::uint32_t to = deposits_[i].to;
        add(deposits_[i].by, to < vertices_ ? weights.scattered[to] : weights.unscattered[to - vertices_]);
      }
      gradient.scattering[step.tet] += sum.by_scattering;
      gradient.absorption[step.tet] += sum.by_absorption;
      by_power = sum.by_power;
    }
    if (ray.light != none) gradient.power[ray.light] += ray.by_power * by_power;
  }
}

}  // namespace quadgraph
