#include "engine/solve/etendue.h"

#include <algorithm>
#include <array>

namespace quadgraph {

bool Etendue::set(device::Device& device, std::span<const Level> levels, std::span<const float> by_body,
                  std::vector<LevelBuffers>& buffers) {
  std::vector<float> found(by_body.begin(), by_body.end());
  if (std::ranges::all_of(found, [](float own) { return own == 1; })) found.clear();
  if (found == by_body_) return false;
  by_body_ = std::move(found);
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    if (!bends()) {
      buffers[i].etendue = {};
      continue;
    }
    std::vector<float> of_tets(levels[i].tet_count());
    for (std::uint32_t t = 0; t < of_tets.size(); ++t) of_tets[t] = of_tet(levels[i], t);
    device::rewrite<float>(device, of_tets, "material/level " + std::to_string(i) + " etendue", buffers[i].etendue);
  }
  return true;
}

float Etendue::in_tet(const Level& level, std::uint32_t tet, Method method) const {
  return bends() && conserves(method) ? of_tet(level, tet) : 1;
}

std::vector<float> Etendue::at_carriers(const Level& level, Method method) const {
  if (!on_vertices(method)) {
    std::vector<float> found(level.node_count(), 1);
    for (std::uint32_t t = 0; t < level.tet_count(); ++t) found[t] = in_tet(level, t, method);
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      found[level.tet_count() + f] = in_tet(level, level.face_tets[f], method);
    }
    return found;
  }
  std::vector<float> sum(level.vertex_count(), 0), count(level.vertex_count(), 0);
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    for (int k = 0; k < 4; ++k) {
      sum[level.tets[t][k]] += in_tet(level, t, method);
      count[level.tets[t][k]] += 1;
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) sum[v] /= std::max(count[v], 1.0f);
  return sum;
}

SharedSurface shared_surface(const Level& level) {
  constexpr std::array<glm::uvec3, 4> opposite{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};  // outward
  std::vector<std::vector<glm::uvec2>> rims(level.vertex_count());
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t across = level.links[t][k];
      if (across >= level.tet_count() || level.body_of_tet(t) >= level.body_of_tet(across)) continue;
      for (int j = 0; j < 3; ++j) {
        const auto corner = [&](int step) { return level.tets[t][opposite[k][(j + step) % 3]]; };
        rims[corner(0)].emplace_back(corner(1), corner(2));
      }
    }
  }
  SharedSurface found;
  found.offset.push_back(0);
  for (std::uint32_t v = 0; v < rims.size(); ++v) {
    if (rims[v].empty()) continue;
    found.vertex.push_back(v);
    found.rim.insert(found.rim.end(), rims[v].begin(), rims[v].end());
    found.offset.push_back(static_cast<std::uint32_t>(found.rim.size()));
  }
  return found;
}

}  // namespace quadgraph
