#include "engine/base/path_options.h"

#include <string>

#include "engine/base/error.h"

namespace quadgraph {

void check_options(const PathOptions& options) {
  if (!path_cells_range.contains(options.cells)) {
    throw InputError("path cells: found " + std::to_string(options.cells) + ", allowed are " + path_cells_range.text());
  }
}

}  // namespace quadgraph
