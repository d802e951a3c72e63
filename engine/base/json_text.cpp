#include "engine/base/json_text.h"

#include <algorithm>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

constexpr std::size_t shown_digits = 40;

// "line 3, column 14" of a byte.
std::string json_place(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const std::size_t line = before.rfind('\n');
  const std::size_t column = before.size() - (line == std::string_view::npos ? 0 : line + 1) + 1;
  return "line " + std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ", column " +
         std::to_string(column);
}

// What stands in quotes in the message of a number that is too large.
std::string quoted(std::string_view message) {
  const std::size_t begin = message.find('\'') + 1, end = message.rfind('\'');
  return begin > 0 && end > begin ? std::string(message.substr(begin, end - begin)) : "one";
}

}  // namespace

void check_json(std::string_view text) {
  if (text.size() > json_bytes) {
    throw InputError("JSON of " + std::to_string(text.size()) + " bytes found, allowed are " +
                     std::to_string(json_bytes));
  }
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\') {
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && (c == '[' || c == '{')) {
      if (++depth <= json_depth) continue;
      throw InputError("JSON nested deeper than " + std::to_string(json_depth) + " levels at " + json_place(text, i) +
                       ", which is the most that is allowed");
    } else if (!quoted && (c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
}

nlohmann::ordered_json parse_json(std::string_view text) {
  check_json(text);
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::ordered_json::parse_error& error) {
    throw InputError("no JSON at " + json_place(text, error.byte > 0 ? error.byte - 1 : 0));
  } catch (const nlohmann::ordered_json::exception& error) {
    const std::string number = quoted(error.what());
    throw InputError("a JSON number beyond double precision at " + json_place(text, text.find(number)) + ": found " +
                     number.substr(0, shown_digits) + ", allowed are up to 1.7e308");
  }
}

}  // namespace quadgraph
