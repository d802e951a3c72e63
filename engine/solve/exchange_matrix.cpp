#include "engine/solve/exchange_matrix.h"

#include <algorithm>

#include "engine/solve/moved_bytes.h"
#include "interface/exchange/exchange_rays.comp.h"
#include "shaders/exchange/exchange_shared.h"

namespace quadgraph {
namespace {

// Workgroups of one dispatch; every device takes 65535.
constexpr std::uint32_t most_rows = 32768;

// Nodes and faces that a ray looks at, about as many as on the bunny; for the bytes.
constexpr std::uint64_t nodes_per_ray = 60, faces_per_ray = 12;

// With room for all rays of every row.
std::vector<glm::uvec2> wide_rows(const Level& level) {
  std::vector<glm::uvec2> rows;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const std::uint32_t begin = f * level.seen_rays;
    rows.emplace_back(begin, begin + level.seen[f + 1] - level.seen[f]);
  }
  return rows;
}

std::vector<std::uint32_t> wide_entries(const Level& level) {
  std::vector<std::uint32_t> entries(level.faces.size() * level.seen_rays, 0);
  for (std::size_t f = 0; f < level.faces.size(); ++f) {
    std::copy(level.seen.begin() + level.seen[f], level.seen.begin() + level.seen[f + 1],
              entries.begin() + static_cast<std::ptrdiff_t>(f * level.seen_rays));
  }
  return entries;
}

}  // namespace

void ExchangeMatrix::make_room(device::Device& device) {
  if (rows_.size() > 0) return;
  std::vector<glm::uvec2> rows;
  for (std::size_t f = 0; f < level_.faces.size(); ++f) rows.emplace_back(level_.seen[f], level_.seen[f + 1]);
  entries_ = device::upload(device, level_.seen, "exchange/entries");
  rows_ = device::upload<glm::uvec2>(device, rows, "exchange/rows");
}

void ExchangeMatrix::make_room_for_rays(device::Device& device) {
  if (cast_) return;
  auto rows = device::upload<glm::uvec2>(device, wide_rows(level_), "exchange/rows");
  auto entries = device::upload<std::uint32_t>(device, wide_entries(level_), "exchange/entries");
  tree_.emplace(device, level_, "exchange");
  rows_ = std::move(rows);
  entries_ = std::move(entries);
  cast_ = true;
}

void ExchangeMatrix::moved() {
  if (tree_) tree_->moved();
  for (std::uint32_t k = behind_; k < behind_since_.size(); ++k) {
    behind_since_[(next_ + k) % behind_since_.size()] = now_;
  }
  behind_ = static_cast<std::uint32_t>(behind_since_.size());
}

void ExchangeMatrix::put_back(device::Device& device) {
  turned();
  behind_ = 0;
  if (!cast_) return;
  const std::vector<glm::uvec2> rows = wide_rows(level_);
  const std::vector<std::uint32_t> entries = wide_entries(level_);
  device::write_bytes(device, rows_, std::as_bytes(std::span(rows)));
  device::write_bytes(device, entries_, std::as_bytes(std::span(entries)));
}

std::uint32_t ExchangeMatrix::record_refresh(Workspace& work, const LevelBuffers& level, std::uint32_t count) {
  ++now_;
  const std::uint32_t wanted = count == 0 ? behind_ : std::min(count, behind_);
  if (wanted == 0) return 0;
  make_room_for_rays(work.recorder.device());
  tree_->record(work, level);
  for (std::uint32_t done = 0; done < wanted; done += most_rows) {
    record_rays(work, level, (next_ + done) % level.face_count, std::min(wanted - done, most_rows));
  }
  next_ = (next_ + wanted) % level.face_count;
  behind_ -= wanted;
  return wanted;
}

void ExchangeMatrix::record_rays(Workspace& work, const LevelBuffers& level, std::uint32_t first, std::uint32_t count) {
  const gpu::TreeRef tree = tree_->ref();
  const gpu::ExchangeRaysPush push{.vertices = level.vertices.address(),
                                   .faces = level.faces.address(),
                                   .order = tree.order,
                                   .leaf_begin = tree.leaf_begin,
                                   .boxes = tree.boxes,
                                   .rows = rows_.address(),
                                   .entries = entries_.address(),
                                   .first = first,
                                   .face_count = level.face_count,
                                   .leaf_count = tree.leaf_count,
                                   .rays = rays()};
  constexpr std::uint64_t face_bytes = index_bytes + sizeof(glm::uvec3) + 3 * vec3_bytes;
  work.recorder.dispatch(
      work.passes.of(shader::exchange_rays), push, std::uint64_t{count} * WORKGROUP_SIZE, "exchange rays",
      std::uint64_t{count} * rays() * (nodes_per_ray * sizeof(gpu::Box) + faces_per_ray * face_bytes));
}

}  // namespace quadgraph
