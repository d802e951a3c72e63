#include "engine/reference/uncollided.h"

#include "engine/reference/follower.h"

namespace quadgraph {
OpenFaces open_faces(const Level& level) {
  std::vector<std::vector<std::uint32_t>> around(level.vertices.size());
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    for (int k = 0; k < 3 && !level.reflecting(f); ++k) around[level.faces[f][k]].push_back(f);
  }
  OpenFaces result;
  for (const auto& faces : around) {
    result.offset.push_back(static_cast<std::uint32_t>(result.face.size()));
    result.face.insert(result.face.end(), faces.begin(), faces.end());
  }
  result.offset.push_back(static_cast<std::uint32_t>(result.face.size()));
  return result;
}

Uncollided uncollided(const Level& level, const Problem& problem, std::span<const BeamLight> beams,
                      const VertexStarts& starts) {
  const FollowedShape shape(level, starts);
  const Medium medium(problem.optical);
  const Follower follower(level, problem, medium, shape);
  Uncollided result;
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    UncollidedLight<double> sum;
    for (const BeamLight& light : beams) add(sum, follower.at(v, light.beam, QuarterLight(light.quarters)));
    result.entry.emplace_back(sum.entry[0], sum.entry[1], sum.entry[2]);
    result.depth.emplace_back(sum.depth[0], sum.depth[1], sum.depth[2]);
  }
  return result;
}

}  // namespace quadgraph
