// One V-cycle on the device: z ~ A^-1 r, linear in r, symmetric and positive, so that conjugate gradients take it as a
// preconditioner. Smoothing is Chebyshev's iteration preconditioned by diagonal blocks; coarse operators are
// assembled anew on every level; the transfer is clamped barycentric, the restriction its transpose.
#pragma once

#include <cstdint>

#include "engine/solve/operators.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

class Multigrid {
 public:
  // `smoothing` steps before and after every correction, 1 or 2. The operators of `key` have been created, with fem;
  // there are at least two levels.
  Multigrid(Workspace& work, Operators& operators, const OperatorKey& key, std::uint32_t smoothing);

  // Whether the levels can be solved on so: there is a coarser one, and the coarsest is small enough for one workgroup.
  static bool possible(Operators& operators, const OperatorKey& key);

  // One cycle from level `top` down, on its r, behind the gates of its state; also takes r^T z for the directions.
  // Nothing is counted for the passes until `did`.
  void record(std::uint32_t top);

  // z of the last cycle from `top` down.
  const device::Buffer& correction(std::uint32_t level) const;

  void did(std::uint32_t top, std::uint32_t cycles) const;

  // One step of the smoother on the level's x, for its b, which an x that was interpolated needs most: it leaves less
  // of what changes from vertex to vertex.
  void record_relaxation(std::uint32_t level);

  // Entries multiplied in one cycle.
  double entries(std::uint32_t top) const;

 private:
  OperatorBuffers& op(std::uint32_t level) const { return operators_.at(key_, level); }
  std::uint32_t coarsest() const { return operators_.count(key_) - 1; }
  double coarse_across() const;  // vertices across the body on the coarsest level
  std::uint32_t coarse_steps() const;
  std::uint64_t smoothing_bytes(const OperatorBuffers& op) const;

  template <typename Push>
  void dispatch(LazyPass& pass, const Push& push, std::uint32_t level, const char* name);

  void record_smoothing(std::uint32_t level, bool from_zero);
  void record_step(std::uint32_t level, const device::Buffer& from, const device::Buffer& to, std::uint32_t number,
                   bool zero, bool reduce);
  void record_restriction(std::uint32_t level);
  void record_prolongation(std::uint32_t level);
  void record_coarse_solve();

  Workspace& work_;
  Operators& operators_;
  OperatorKey key_;
  std::uint32_t smoothing_;
  std::uint32_t top_ = 0;
};

}  // namespace quadgraph
