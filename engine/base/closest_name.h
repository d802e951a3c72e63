// What somebody meant who wrote a name that there is not.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace quadgraph {

// " (did you mean 'NAME'?)" with the one of `names` that `found` is a slip of: other capitals, hyphens or underscores
// left out or put in, one letter in three wrong, or one more where the first is right; else nothing.
std::string meant(std::string_view found, std::span<const std::string_view> names);

}  // namespace quadgraph
