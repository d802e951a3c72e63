// The four kinds of failure a caller can meet. Every message says where (file and field), what was found, and what is
// allowed. Programming mistakes are asserted instead.
#pragma once

#include <stdexcept>
#include <string>

#include "engine/base/message.h"

namespace quadgraph {

// What all have in common: the message is kept short (engine/base/message.h).
struct Error : std::runtime_error {
  explicit Error(const std::string& message) : std::runtime_error(shortened(message)) {}
};

// A .qgraph file that breaks docs/qgraph-format.md.
struct FormatError : Error {
  using Error::Error;
};

// A scene, option or array that cannot be used.
struct InputError : Error {
  using Error::Error;
};

// A linear solve that broke down or diverged.
struct SolverError : Error {
  using Error::Error;
};

// A device that failed, has no room left, or lacks what the engine needs.
struct DeviceError : Error {
  using Error::Error;
};

}  // namespace quadgraph
