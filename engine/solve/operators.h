// The operators of all levels for every method and model solved so far, and the way of a solution from level to level.
#pragma once

#include <compare>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "engine/solve/level_upload.h"
#include "engine/solve/operator_buffers.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

// What an operator is made for.
struct OperatorKey {
  Method method;
  Model model;

  auto operator<=>(const OperatorKey&) const = default;
};

class Operators {
 public:
  // Uploads the structures of all levels, unless they are there.
  void create(vk::Context& context, std::span<const Level> levels, const OperatorKey& key);

  // Of a key that has been created.
  OperatorBuffers& at(const OperatorKey& key, std::uint32_t level) { return *levels_.at(key)[level].op; }

  void unload();                         // light has changed: every b is stale
  void disassemble();                    // coefficients have changed: every operator is
  void remeasure(std::uint32_t number);  // vertices of a level have moved: its elements have, too

  // x of `level` from that of the next coarser one.
  void record_transfer(Workspace& work, const OperatorKey& key, std::uint32_t level);

 private:
  struct OfLevel {
    std::optional<OperatorBuffers> op;
    std::optional<TransferBuffers> transfer;
  };

  std::map<OperatorKey, std::vector<OfLevel>> levels_;
};

}  // namespace quadgraph
