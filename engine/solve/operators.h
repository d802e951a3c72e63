// The operators of all levels for every method and model solved so far, and the way of a solution from level to level.
#pragma once

#include <compare>
#include <map>
#include <memory>
#include <optional>
#include <set>
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
  // Makes what operators of all levels need, unless it is there. `even`: the coefficients are the same everywhere;
  // `two_steps`: cycles smooth in two steps.
  void create(device::Device& device, std::span<const Level> levels, const OperatorKey& key, bool even, bool two_steps);

  // The operator of a level, for a key that has been created.
  OperatorBuffers& at(const OperatorKey& key, std::uint32_t level) { return *levels_.at(key)[level].op; }

  // For a key that has been created: how many levels it has, at most MAX_LEVELS; the transfer to `level` from the next
  // coarser one.
  std::uint32_t count(const OperatorKey& key) const { return static_cast<std::uint32_t>(levels_.at(key).size()); }
  const TransferBuffers& transfer(const OperatorKey& key, std::uint32_t level) const {
    return *levels_.at(key)[level].transfer;
  }

  void unload();       // light has changed: every b is stale
  void disassemble();  // coefficients have changed: every operator is

  // Vertices of a level, now `level`, have moved: its elements have, too. Where packed entries would round too much
  // now, the operators are to be created again, with plain ones.
  void remeasure(std::uint32_t number, const Level& level);

  // Vertices of a level have been moved by the device; `conduction`: its mean, as format_of takes it.
  void remeasure(std::uint32_t number, double conduction);

  // What the coefficients of an operator that is to be created make of packed entries (Coefficients::packed_rounding).
  void rounded(const OperatorKey& key, double rounding);

  // What was made is made again.
  void forget();
  // Volumes count for something else.
  void measure_anew();

  // All vertices lie as in the file again.
  void put_back();

  // `target`, as x of `level`, from x of the next coarser one, in the channels that `state`, of a level that was solved
  // for the same light, tells to be lit.
  void record_transfer(Workspace& work, const OperatorKey& key, std::uint32_t level, const device::Buffer& target,
                       const device::Buffer& state);

  // x of `level` from the last solution, with what has changed on the next coarser one since; `changed`: that there is
  // such a level.
  void record_follow(Workspace& work, const OperatorKey& key, std::uint32_t level, bool changed);

 private:
  struct OfLevel {
    std::optional<OperatorBuffers> op;
    std::optional<TransferBuffers> transfer;
  };

  LevelElements& elements(std::uint32_t number);
  void moved(std::uint32_t number);

  static void write_gates(device::Device& device, const std::vector<OfLevel>& levels, std::uint32_t number);

  std::vector<std::unique_ptr<LevelElements>> elements_;  // by level, of all operators on it
  std::map<OperatorKey, std::vector<OfLevel>> levels_;
  std::set<OperatorKey> plain_;  // on all levels, since a motion or by their material
  bool plain_on_device_ = false;
};

}  // namespace quadgraph
