// How good a picture can be while things change: it must not take longer than a budget.
#pragma once

#include <cstdint>

namespace quadgraph {

class Pace {
 public:
  // `budget_ms` for a picture in motion, light and solve included.
  explicit Pace(double budget_ms) : budget_ms_(budget_ms) {}

  // What light and solve of a picture in motion took, with or without the transport correction.
  void solved(double solve_ms, bool corrected);

  // What drawing so many pixels took, with or without gathering.
  void drawn(double draw_ms, double pixels, bool gathered);

  // Whether there is time for the correction, as measured, or as far as a solve without lets expect.
  bool corrects() const;

  // Whether there is time to gather radiance along view rays. `solving`: light or solve come before the drawing.
  bool gathers(bool solving) const { return !solving || solve_ms_ < budget_ms_; }

  // Side of a picture in motion, as a share of the whole one of so many pixels: 1, or less where that takes too long.
  float share(double pixels, bool solving) const;

 private:
  double budget_ms_;
  double solve_ms_ = 0;
  double plain_ms_ = 0, corrected_ms_ = 0;
  double draw_ns_[2] = {0, 0};  // per pixel, without and with gathering
};

}  // namespace quadgraph
