// What a program is to write, held against what it reads before any work is done.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace quadgraph {

// Throws InputError where `output` is one of the inputs, by whatever name, or nothing that may be replaced
// (check_replaceable), or has no folder to lie in. Inputs: texts that may name files.
void check_not_read(const std::filesystem::path& output, std::span<const std::string> inputs);

}  // namespace quadgraph
