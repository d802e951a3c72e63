// The bodies of a .qgraph file by name, which its metadata list, and which of them lie within others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace quadgraph {

inline constexpr std::size_t most_bodies = 256;  // a tet's is a byte
inline constexpr std::size_t most_name_bytes = 64;

// Whether a name can be that of a body: 1 to most_name_bytes bytes, no control characters, and none of "=", "/", "~",
// which command lines and paths into scenes would split it at.
bool is_body_name(std::string_view name);

// Names in their order, none of one body without a name. Throws FormatError naming `file` where the metadata, a JSON
// object as text, have others than 1 to most_bodies different ones.
std::vector<std::string> body_names(const std::string& metadata, const std::string& file);

// Of each of these bodies the number of the one that it lies within and shares its surface with; its own where there is
// none. Throws FormatError naming `file` where the metadata name a body that there is not, or lead in a circle.
std::vector<std::uint32_t> body_hosts(const std::string& metadata, const std::vector<std::string>& names,
                                      const std::string& file);

// Of each body the outermost one around it, by their hosts as body_hosts has them; its own number where there is none.
std::vector<std::uint32_t> outermost_bodies(const std::vector<std::uint32_t>& hosts);

}  // namespace quadgraph
