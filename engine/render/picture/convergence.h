// How a picture came to the error that was asked for.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/reference/solution.h"

namespace quadgraph {

struct ConvergenceStep {
  std::uint32_t solves = 1;   // that the picture is the mean of, each by samples of its own
  std::uint32_t sweeps = 0;   // of the transport equation, in each
  double points = 0;          // at which the last of them evaluated it
  std::uint32_t samples = 0;  // of a pixel
  double seconds = 0;         // since the first step, which is the picture without convergence
  ErrorEstimate error{};      // that is stated of the picture, model and noise included
  double noise = 0;           // of it: standard error, relative RMS over the pixels that the body covers; 0: not known
};

struct Convergence {
  double wanted = 0;  // error of the whole picture
  bool reached = false;
  bool out_of_time = false;
  double least = 0;     // what more solves and samples would leave of the error; 0: not known
  std::string limit{};  // why it was not reached and what helps; empty if it was
  std::vector<ConvergenceStep> steps{};
  SolveReport solve{};  // the last; its error is that of the mean
};

}  // namespace quadgraph
