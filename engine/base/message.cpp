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

}  // namespace

std::string shortened(const std::string& text) {
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
