#include "engine/cpu/raster.h"

#include "engine/cpu/tile.h"

namespace quadgraph::cpu {

void rasterise(Processor& processor, const device::DrawImages& target, const device::Viewport& viewport,
               const GraphicsPipeline& pass, const void* push, const std::uint32_t* indices, std::uint32_t vertices) {
  const Frame frame{target, viewport, pass, push, position_floats + 4 * pass.options.vertex->locations};
  const std::uint32_t tiles = frame.columns() * frame.rows();
  static_cast<ImageMemory&>(*target.depth).start_draw(target.width, target.height, tiles);
  for (device::ImageMemory* colour : target.colours) {
    static_cast<ImageMemory&>(*colour).start_draw(target.width, target.height, tiles);
  }
  const DrawMemory& memory = processor.draw_memory();
  set_up(processor, frame, indices, vertices);
  processor.run(tiles, 1, [&](std::uint32_t begin, std::uint32_t end) {
    Tile tile(frame);
    for (std::uint32_t k = begin; k < end; ++k) tile.draw(k, memory);
  });
}

}  // namespace quadgraph::cpu
