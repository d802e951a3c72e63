// Texts of errors, kept short whatever they quote.
#pragma once

#include <cstddef>
#include <string>

namespace quadgraph {

inline constexpr std::size_t message_bytes = 440;  // and the program's name before them is still less than 480

// The text with the middle of long words, and then its own, left out ("...") where it is longer than message_bytes:
// what it begins with, the place, and what it ends with, the next step, stay. No character of UTF-8 is cut. Control
// characters stand there as \xNN. python/quadgraph/base/message.py does the same.
std::string shortened(const std::string& said);

}  // namespace quadgraph
