#include "engine/base/range.h"

#include <charconv>

namespace quadgraph {
namespace {

std::string number_text(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

}  // namespace

std::string Range::text() const {
  if (!has_low() && !has_high()) return "any";
  const std::string first = number_text(low), last = number_text(high);
  if (!has_high()) return above ? "more than " + first : first + " or more";
  if (!has_low()) return below ? "less than " + last : "at most " + last;
  if (!above && !below) return first + " to " + last;
  return (above ? "more than " + first : "at least " + first) + (below ? ", below " + last : ", at most " + last);
}

}  // namespace quadgraph
