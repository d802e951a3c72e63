// What the text of any JSON document must keep to before it is parsed: parsers and what walks their values recurse.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace quadgraph {

inline constexpr std::size_t json_depth = 64;  // brackets in each other
inline constexpr std::size_t json_bytes = std::size_t{64} << 20;

// "line 3, column 14" of a byte.
std::string json_place(std::string_view text, std::size_t byte);

// Throws InputError naming place, what was found and what is allowed where a text is too long or too deep.
void check_json(std::string_view text);

}  // namespace quadgraph
