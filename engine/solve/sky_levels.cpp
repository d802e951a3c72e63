#include "engine/solve/sky_levels.h"

#include "engine/reference/sky.h"
#include "interface/exchange/exchange_sky.comp.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t entry_bytes = sizeof(std::uint32_t) + 2 * sizeof(float);  // index, weight, and what is read

}  // namespace

SkyLevels::SkyLevels(device::Device& device, std::span<const Level> levels, std::uint32_t known)
    : known_(known), rows_(levels.size()) {
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    if (i == known) continue;
    const SkyRows rows = i < known ? finer_sky_rows(levels[i]) : coarser_sky_rows(levels[i - 1], levels[i]);
    rows_[i] = {device::upload<std::uint32_t>(device, rows.offset, "exchange/sky_offset"),
                device::upload<std::uint32_t>(device, rows.index, "exchange/sky_index"),
                device::upload<float>(device, rows.weight, "exchange/sky_weight")};
  }
}

void SkyLevels::record_from(Workspace& work, const Rows& rows, const LevelBuffers& from,
                            const LevelBuffers& level) const {
  const gpu::ExchangeSkyPush push{.rows = 0,
                                  .offset = rows.offset.address(),
                                  .index = rows.index.address(),
                                  .weight = rows.weight.address(),
                                  .from = from.sky.address(),
                                  .sky = level.sky.address(),
                                  .count = level.face_count,
                                  .rays = 0};
  work.recorder.dispatch(work.passes.of(shader::exchange_sky), push, level.face_count, "sky",
                         rows.offset.size() + rows.index.size() / sizeof(std::uint32_t) * entry_bytes);
}

void SkyLevels::record(Workspace& work, const ExchangeMatrix& matrix, std::span<const LevelBuffers> levels) const {
  const LevelBuffers& known = levels[known_];
  gpu::ExchangeSkyPush push{};
  push.rows = matrix.rows().address();
  push.sky = known.sky.address();
  push.count = known.face_count;
  push.rays = matrix.rays();
  work.recorder.dispatch(work.passes.of(shader::exchange_sky), push, known.face_count, "sky",
                         (sizeof(glm::uvec2) + sizeof(float)) * known.face_count);
  for (std::uint32_t i = known_; i-- > 0;) record_from(work, *rows_[i], levels[i + 1], levels[i]);
  for (std::uint32_t i = known_ + 1; i < levels.size(); ++i) record_from(work, *rows_[i], levels[i - 1], levels[i]);
}

}  // namespace quadgraph
