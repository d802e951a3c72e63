// Bodies that will not stay where they are, copied to where scenes that name them find them.
#pragma once

#include <filesystem>

namespace quadgraph {

// The file in `folder` that holds what `body` does: one of its name, or with a number after it, that is the same byte
// for byte, else a new copy. Throws InputError naming the file.
std::filesystem::path copied_into(const std::filesystem::path& folder, const std::filesystem::path& body);

}  // namespace quadgraph
