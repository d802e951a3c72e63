#include "engine/base/range.h"

#include <cmath>
#include <cstdint>

#include "engine/base/text.h"

namespace quadgraph {
namespace {

// A million as 1000000.
std::string end_text(double end) {
  const bool whole = end == std::floor(end) && std::abs(end) < 1e15;
  return whole ? std::to_string(static_cast<std::int64_t>(end)) : number_text(end);
}

}  // namespace

std::string Range::text() const {
  if (!has_low() && !has_high()) return "any";
  const std::string first = end_text(low), last = end_text(high);
  if (!has_high()) return above ? "more than " + first : first + " or more";
  if (!has_low()) return below ? "less than " + last : "at most " + last;
  if (!above && !below) return first + " to " + last;
  return (above ? "more than " + first : "at least " + first) + (below ? ", below " + last : ", at most " + last);
}

}  // namespace quadgraph
