// JSON from files of others, within limits: parsers and what walks their values recurse.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace quadgraph {

inline constexpr std::size_t json_depth = 64;  // brackets in each other
inline constexpr std::size_t json_bytes = std::size_t{64} << 20;

// Throws InputError naming place, what was found and what is allowed where a text is too long or too deep.
void check_json(std::string_view text);

// The value of a document, which is checked. Throws InputError that says where it is none.
nlohmann::ordered_json parse_json(std::string_view text);

}  // namespace quadgraph
