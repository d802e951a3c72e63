#include "engine/file/polygrid.h"

namespace quadgraph {

std::vector<std::uint32_t> grid_layers(const Level& level) {
  const std::uint32_t first = level.surface_vertex_count, count = level.vertex_count();
  std::vector<std::uint32_t> offset(count + 1, 0);
  for (const std::uint32_t link : level.grid_links) ++offset[link + 1];
  for (std::uint32_t v = 0; v < count; ++v) offset[v + 1] += offset[v];
  std::vector<std::uint32_t> linking(level.grid_links.size()), next(offset.begin(), offset.end() - 1);
  for (std::size_t i = 0; i < level.grid_links.size(); ++i) {
    linking[next[level.grid_links[i]]++] = first + static_cast<std::uint32_t>(i / grid_link_count);
  }
  std::vector<std::uint32_t> layer(count, no_layer), queue;
  queue.reserve(count);
  for (std::uint32_t v = 0; v < first; ++v) {
    layer[v] = 0;
    queue.push_back(v);
  }
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const std::uint32_t v = queue[i];
    for (std::uint32_t k = offset[v]; k < offset[v + 1]; ++k) {
      if (layer[linking[k]] != no_layer) continue;
      layer[linking[k]] = layer[v] + 1;
      queue.push_back(linking[k]);
    }
  }
  return layer;
}

std::vector<std::uint32_t> grid_neighbours(const Level& level) {
  std::vector<std::uint32_t> neighbour(level.surface_vertex_count, 0);
  for (std::size_t i = 0; i < level.grid_links.size(); ++i) {
    const std::uint32_t link = level.grid_links[i];
    if (link < level.surface_vertex_count) {
      neighbour[link] = level.surface_vertex_count + static_cast<std::uint32_t>(i / grid_link_count);
    }
  }
  return neighbour;
}

}  // namespace quadgraph
