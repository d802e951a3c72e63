#include "engine/deform/motion.h"

#include "engine/file/graph.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t graph_steps = 20;    // on the finest level, of methods without cycles
constexpr std::uint32_t exchange_parts = 8;  // a view of the other parts is up to so many frames old

// Faces of the level that has the exchange between faces.
std::uint32_t exchange_faces(std::span<const Level> levels) {
  for (const Level& level : levels) {
    if (!level.seen.empty()) return level.face_count();
  }
  return 0;
}

}  // namespace

SolveOptions in_motion(SolveOptions options, std::span<const Level> levels) {
  if (options.method == Method::shortest_path) return options;
  const bool cycles = options.method == Method::fem;
  options.solver = cycles ? SolverKind::fmg_pcg : symmetric(options.method) ? SolverKind::dpcg : SolverKind::cascade;
  options.cycles = cycles ? 1 : graph_steps;
  options.bounces = 1;
  options.warm = true;
  options.error = 0;
  options.sweeps = 0;  // one a frame, where it corrects
  options.certify = 0;
  options.mean_rays = true;
  options.exchange_rows = (exchange_faces(levels) + exchange_parts - 1) / exchange_parts;
  return options;
}

}  // namespace quadgraph
