// What is measured: every layout, and every way to put a step of the solver into dispatches.
#pragma once

#include <string>
#include <vector>

#include "tools/layouts/layout.h"

namespace quadgraph::layouts {

enum class Operation {
  product,           // y = A x
  product_dot,       // and the sum of x y
  product_then_dot,  // the sum's last stage in a second dispatch
  smooth,            // one Chebyshev step in one dispatch
  residual_update,   // the same in two
  smooth_zero,       // two Chebyshev steps from zero in one dispatch
  start_smooth,      // the same in two
};

struct Variant {
  std::string group;   // "rows", "entries", ...; those of one group compete
  std::string name;    // what it is
  std::string kernel;  // tools/layouts/CMakeLists.txt
  Operation operation = Operation::product;
  Layout layout;
  bool subgroups = false;  // needs subgroup arithmetic
};

std::vector<Variant> all_variants();

// The layout of the engine (shaders/solver/solve_shared.h).
inline constexpr Layout present{};

}  // namespace quadgraph::layouts
