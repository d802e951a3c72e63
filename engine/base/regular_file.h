// Files that are to be read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace quadgraph {

// The bytes of a regular file. Throws InputError if there is none of that name, if the system does not let it be looked
// at (a loop of links, a folder without the right), or if it is something else: nobody may ever write the end of a
// pipe.
std::uintmax_t bytes_of_regular_file(const std::filesystem::path& path);

// The text of a regular file. Throws InputError as above, and where it has more bytes than are allowed of `what` it is.
std::string text_of_regular_file(const std::filesystem::path& path, std::uintmax_t allowed, const std::string& what);

}  // namespace quadgraph
