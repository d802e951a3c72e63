// The numbers that an option or a member of a light allows.
#pragma once

#include <limits>
#include <string>

namespace quadgraph {

struct Range {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool above = false, below = false;  // `low` itself is not allowed, `high` itself is not

  bool operator==(const Range&) const = default;

  // Never of infinities and NaN. The ends count as numbers of the type of `value`.
  template <typename T>
  constexpr bool contains(T value) const {
    const T first = static_cast<T>(low), last = static_cast<T>(high);
    const bool finite = value - value == T{0};
    return finite && (above ? value > first : value >= first) && (below ? value < last : value <= last);
  }

  constexpr bool has_low() const { return low > -std::numeric_limits<double>::infinity(); }
  constexpr bool has_high() const { return high < std::numeric_limits<double>::infinity(); }

  // "0.02 to 1", "more than 0, at most 90", "more than 0", "any".
  std::string text() const;
};

}  // namespace quadgraph
