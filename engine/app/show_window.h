// The program's window.
#pragma once

#include "engine/app/options.h"

namespace quadgraph {

// Until the user closes it; the exit code. Throws InputError where there is no display, or nothing to show on it by,
// and names --headless.
int show_window(const AppOptions& options);

}  // namespace quadgraph
