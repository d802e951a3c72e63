// What the faces of one level see of each other, on the device: rows as baked, and cast anew on the device when the
// shape has changed, some at each call in turn, so that a body in motion has a matrix that lags behind by a known age.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/solve/body_tree.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

class ExchangeMatrix {
 public:
  // `level` has `seen` and must stay alive; its vertices are those of the bake. Buffers are made at first use.
  explicit ExchangeMatrix(const Level& level) : level_(level), behind_since_(level.faces.size(), 0) {}

  // No face sees another, for all that is known.
  bool empty() const { return !cast_ && level_.seen.size() == level_.faces.size() + 1; }

  // The shape has changed: all rows are behind it.
  void moved();

  // It has turned as a whole, which no row is behind.
  void turned() {
    if (tree_) tree_->moved();
  }

  // The shape is that of the file again: so are all rows.
  void put_back(device::Device& device);

  // Casts the rays of up to `count` rows that are behind the shape of `level`, the longest behind first; of all with 0.
  // Returns how many. To be called once in a solve, by which ages are counted.
  std::uint32_t record_refresh(Workspace& work, const LevelBuffers& level, std::uint32_t count);

  // Solves since the shape left the row that has been behind it for longest; 0 if none is.
  std::uint32_t age() const { return behind_ > 0 ? now_ - behind_since_[next_] : 0; }

  void make_room(device::Device& device);
  const device::Buffer& rows() const { return rows_; }        // uvec2 per face: first entry, and one past the last
  const device::Buffer& entries() const { return entries_; }  // faces that were met

  std::uint32_t rays() const { return level_.seen_rays; }

 private:
  void make_room_for_rays(device::Device& device);
  void record_rays(Workspace& work, const LevelBuffers& level, std::uint32_t first, std::uint32_t count);

  const Level& level_;
  device::Buffer rows_, entries_;
  bool cast_ = false;  // entries_ has room for all rays of every row
  std::optional<BodyTree> tree_;

  // Rows next_, next_ + 1, ... modulo the number of faces are behind the shape, behind_ of them.
  std::uint32_t next_ = 0, behind_ = 0;
  std::uint32_t now_ = 0;                    // solves
  std::vector<std::uint32_t> behind_since_;  // by row, of those that are
};

}  // namespace quadgraph
