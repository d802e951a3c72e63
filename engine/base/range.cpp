#include "engine/base/range.h"

#include "engine/base/text.h"

namespace quadgraph {

std::string Range::text() const {
  if (!has_low() && !has_high()) return "any";
  const std::string first = number_text(low), last = number_text(high);
  if (!has_high()) return above ? "more than " + first : first + " or more";
  if (!has_low()) return below ? "less than " + last : "at most " + last;
  if (!above && !below) return first + " to " + last;
  return (above ? "more than " + first : "at least " + first) + (below ? ", below " + last : ", at most " + last);
}

}  // namespace quadgraph
