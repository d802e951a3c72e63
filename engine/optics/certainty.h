// How well coefficients are known, as those who acquired them say.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace quadgraph {

enum class Knowledge : std::size_t {
  sigma_s_prime_deviation,  // standard deviation of its logarithm, a relative one where it is small
  sigma_a_deviation,
  sigma_s_prime_resolution,  // length over which it is one number, mm
  sigma_a_resolution,
};

inline constexpr std::array<std::string_view, 4> knowledge_names = {"sigma_s_prime_deviation", "sigma_a_deviation",
                                                                    "sigma_s_prime_resolution", "sigma_a_resolution"};

constexpr bool is_length(Knowledge knowledge) {
  return knowledge == Knowledge::sigma_s_prime_resolution || knowledge == Knowledge::sigma_a_resolution;
}

// Larger ones, and infinite ones, which say as little, are taken for it.
constexpr float most_stated(Knowledge knowledge) {
  return is_length(knowledge) ? 1e9f : 1e3f;
}

// Of each place the mean of the channels; empty where it is not stated.
struct Certainty {
  std::array<std::vector<float>, knowledge_names.size()> stated;

  const std::vector<float>& of(Knowledge knowledge) const { return stated[static_cast<std::size_t>(knowledge)]; }
  bool states(Knowledge knowledge) const { return !of(knowledge).empty(); }
};

}  // namespace quadgraph
