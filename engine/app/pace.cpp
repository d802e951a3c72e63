#include "engine/app/pace.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace quadgraph {
namespace {

// What was measured last counts as much as all before it: a first picture compiles what later ones find compiled.
double mixed(double before, double now) {
  return before > 0 ? 0.5 * (before + now) : now;
}

constexpr double least_drawing = 0.35;      // of the budget, or of the solve where that takes longer
constexpr double corrected_over_plain = 4;  // time of a solve with the correction over that of one without
constexpr float shares[] = {1.0f, 0.75f, 0.5f, 0.375f};

}  // namespace

void Pace::solved(double solve_ms, bool corrected) {
  solve_ms_ = mixed(solve_ms_, solve_ms);
  double& known_ms = corrected ? corrected_ms_ : plain_ms_;
  known_ms = mixed(known_ms, solve_ms);
}

void Pace::drawn(double draw_ms, double pixels, bool gathered) {
  double& draw_ns = draw_ns_[gathered ? 1 : 0];
  if (pixels > 0) draw_ns = mixed(draw_ns, 1e6 * draw_ms / pixels);
}

bool Pace::corrects() const {
  if (corrected_ms_ > 0) return corrected_ms_ < budget_ms_;
  return plain_ms_ > 0 && corrected_over_plain * plain_ms_ < budget_ms_;
}

float Pace::share(double pixels, bool solving) const {
  const double solve_ms = solving ? solve_ms_ : 0;
  const double left = std::max(budget_ms_ - solve_ms, least_drawing * std::max(budget_ms_, solve_ms));
  for (const float share : shares) {
    const double side = static_cast<double>(share);
    if (1e-6 * draw_ns_[gathers(solving) ? 1 : 0] * pixels * side * side <= left) return share;
  }
  return std::end(shares)[-1];
}

}  // namespace quadgraph
