// How good a picture can be while things change: it must not take longer than a budget.
#pragma once

#include <cstdint>

namespace quadgraph {

class Pace {
 public:
  // `budget_ms` for a picture in motion, light and solve included.
  explicit Pace(double budget_ms) : budget_ms_(budget_ms) {}

  // What a picture took: light and solve, and drawing so many pixels.
  void took(double solve_ms, double draw_ms, double pixels);

  // Side of a picture in motion, as a share of the whole one of so many pixels: 1, or less where that takes too long.
  // `solving`: whether light or solve come before it.
  float share(double pixels, bool solving) const;

 private:
  double budget_ms_;
  double solve_ms_ = 0;
  double draw_ns_ = 0;  // per pixel
};

}  // namespace quadgraph
