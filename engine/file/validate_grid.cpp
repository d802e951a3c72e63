#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/file/polygrid.h"
#include "engine/file/section_table.h"
#include "engine/file/validate.h"

namespace quadgraph {

void validate_grid(const Level& level, const std::string& file, std::uint32_t index) {
  if (level.grid_links.empty()) return;
  const std::string section = "level" + std::to_string(index) + "/grid_links";
  const auto fail = [&](std::size_t row, const std::string& rule) {
    fail_format(file, section, "row " + std::to_string(row) + ": " + rule);
  };
  const std::uint32_t first = level.surface_vertex_count, count = level.vertex_count();
  const std::size_t rows = level.grid_links.size() / grid_link_count;
  if (rows != count - first) {
    fail_format(file, section, std::to_string(rows) + " rows, expected " + std::to_string(count - first));
  }
  std::vector<bool> named(first, false);
  for (std::size_t i = 0; i < level.grid_links.size(); ++i) {
    const std::uint32_t link = level.grid_links[i];
    const std::size_t row = i / grid_link_count;
    if (link >= count) {
      fail(row, "index " + std::to_string(link) + ", allowed is below " + std::to_string(count));
    }
    if (link == first + row && i % grid_link_count + 1 < grid_link_count) fail(row, "linked to itself");
    if (link >= first) continue;
    if (named[link]) fail(row, "vertex " + std::to_string(link) + " of the surface is linked a second time");
    named[link] = true;
  }
  const auto lonely = std::find(named.begin(), named.end(), false);
  if (lonely != named.end()) {
    fail_format(file, section, "vertex " + std::to_string(lonely - named.begin()) + " of the surface is not linked");
  }
  const std::vector<std::uint32_t> layer = grid_layers(level);
  for (std::uint32_t v = first; v < count; ++v) {
    if (layer[v] == no_layer) fail(v - first, "not linked to the surface");
    if (layer[v] < layer[v - 1]) fail(v - first, "vertices are not in the order of their layers");
  }
}

void validate_grid_everywhere(std::span<const Level> levels, const std::string& file) {
  for (std::size_t i = 1; i < levels.size(); ++i) {
    if (levels[i].grid_links.empty() != levels[0].grid_links.empty()) {
      fail_format(file, "level" + std::to_string(i) + "/grid_links", "all levels must have it, or none");
    }
  }
}

}  // namespace quadgraph
