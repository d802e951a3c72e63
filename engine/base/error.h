// The four kinds of failure a caller can meet. Every message says where (file and field), what was found, and what is
// allowed. Programming mistakes are asserted instead.
#pragma once

#include <stdexcept>
#include <string>

namespace quadgraph {

// A .qgraph file that breaks docs/qgraph-format.md.
struct FormatError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A scene, option or array that cannot be used.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A linear solve that broke down or diverged.
struct SolverError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A device that failed, has no room left, or lacks what the engine needs.
struct DeviceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace quadgraph
