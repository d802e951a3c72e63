// From which side a body is shown when nobody says so: python/quadgraph/mesh/front.py chooses it, a .qgraph file keeps
// it.
#pragma once

#include <filesystem>
#include <string>

namespace quadgraph {

// Degrees about y, as of a view, that metadata names; 0 where it names none. Throws FormatError naming `file` unless it
// is a number of -180 to 360.
float front_from(const std::string& metadata, const std::string& file);

// The front that a file's metadata names; nothing else is read. 0 where that fails: whoever loads the body says why.
float front_of(const std::filesystem::path& file);

}  // namespace quadgraph
