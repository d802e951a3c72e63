// How certain coefficients are, as those who acquired them say.
#pragma once

#include <vector>

namespace quadgraph {

// Standard deviations of the coefficients' logarithms, which are relative ones where they are small; of each place the
// mean of the channels. Empty where they are not known.
struct Deviations {
  std::vector<float> sigma_s_prime, sigma_a;
};

}  // namespace quadgraph
