// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <functional>

namespace quadgraph {

// Throws InputError unless `path` is a regular file, which may be replaced, or a new name.
void check_replaceable(const std::filesystem::path& path);

// Calls `write` with a temporary path in the directory of `path`, then renames it to `path`. On any exception the
// temporary file is removed and InputError naming `path` is thrown.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

}  // namespace quadgraph
