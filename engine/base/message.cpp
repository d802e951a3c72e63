#include "engine/base/message.h"

#include <algorithm>

namespace quadgraph {
namespace {

constexpr std::size_t long_word = 100;  // longer ones keep so much on either side:
constexpr std::size_t kept_of_word = 45;
constexpr std::size_t kept_first = 180, kept_last = 250;  // of a whole text; less than message_bytes with the dots
constexpr const char* blanks = " \t\r\n";
constexpr const char* dots = "...";

bool begins_character(const std::string& text, std::size_t at) {
  return at >= text.size() || (static_cast<unsigned char>(text[at]) & 0xc0u) != 0x80u;
}

// At most so many bytes of the beginning and of the end.
std::string ends_of(const std::string& text, std::size_t first, std::size_t last) {
  while (!begins_character(text, first)) --first;
  std::size_t from = text.size() - last;
  while (!begins_character(text, from)) ++from;
  return text.substr(0, first) + dots + text.substr(from);
}

// Whether a terminal would obey the character that begins there: a control character of ASCII but for a tab and the
// end of a line, or one of the second set, U+0080 to U+009F.
bool obeyed(const std::string& text, std::size_t at) {
  const auto byte = static_cast<unsigned char>(text[at]);
  if (byte == 0xc2u && at + 1 < text.size()) return static_cast<unsigned char>(text[at + 1]) < 0xa0u;
  return (byte < 0x20u && byte != '\t' && byte != '\n') || byte == 0x7fu;
}

// The text with what a terminal would obey as \xNN.
std::string printable(const std::string& text) {
  constexpr const char* digits = "0123456789abcdef";
  std::string result;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (!obeyed(text, at)) {
      result += text[at];
      continue;
    }
    if (static_cast<unsigned char>(text[at]) == 0xc2u) ++at;
    const auto byte = static_cast<unsigned char>(text[at]);
    result += {'\\', 'x', digits[byte / 16], digits[byte % 16]};
  }
  return result;
}

}  // namespace

std::string shortened(const std::string& said) {
  const std::string text = printable(said);
  if (text.size() <= message_bytes) return text;
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t word = std::min(text.find_first_not_of(blanks, at), text.size());
    const std::size_t end = std::min(text.find_first_of(blanks, word), text.size());
    result += text.substr(at, word - at);
    const std::string whole = text.substr(word, end - word);
    result += whole.size() > long_word ? ends_of(whole, kept_of_word, kept_of_word) : whole;
    at = end;
  }
  return result.size() > message_bytes ? ends_of(result, kept_first, kept_last) : result;
}

}  // namespace quadgraph
