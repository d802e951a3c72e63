// How an engine moves its bodies, and what is said where they come to overlap.
#include <algorithm>

#include "engine/render/engine_implementation.h"
#include "engine/render/overlap.h"

namespace quadgraph {

void Engine::set_deformation(std::span<const Deformer> list) {
  const auto turn = implementation_->in_use.take();
  implementation_->set_shape(list, BodyPoses(implementation_->poses));
}

void Engine::set_placements(const BodyPoses& poses) {
  const auto turn = implementation_->in_use.take();
  const std::vector<Deformer> list = implementation_->steps;
  implementation_->set_shape(list, poses);
}

void Engine::set_shape(std::span<const Deformer> list, const BodyPoses& poses) {
  const auto turn = implementation_->in_use.take();
  implementation_->set_shape(list, poses);
}

// Throws InputError, and changes nothing then.
std::vector<Deformer> Engine::Implementation::checked(std::span<const Deformer> list, const BodyPoses& wanted) {
  for (const Deformer& deformer : list) check_deformer(deformer);
  check_shapes(list, graph);
  std::vector<Deformer> all(list.begin(), list.end());
  if (wanted.empty()) return all;
  if (!vertices_of_bodies) vertices_of_bodies = std::make_shared<const VertexBodies>(vertex_bodies(graph));
  std::vector<RigidMove> moves = rigid_moves(graph, *vertices_of_bodies, wanted);
  const bool any = std::ranges::any_of(moves, [](const RigidMove& move) { return move != RigidMove(); });
  if (any) all.insert(all.begin(), placed(std::move(moves), vertices_of_bodies));
  return all;
}

void Engine::Implementation::set_shape(std::span<const Deformer> list, const BodyPoses& wanted) {
  const std::vector<Deformer> all = checked(list, wanted);
  const auto also = [&](Workspace& work) { motion.record(work, all, mesh); };
  const bool changes = !simulation || simulation->set_deformation(all, motion.rest_box(), also);
  if (!simulation) {
    if (!motion_work) motion_work.emplace(device, mesh.vertex_count);
    motion_work->recorder.clear();
    also(*motion_work);
    motion_work->recorder.submit();
  }
  steps.assign(list.begin(), list.end());
  poses = wanted;
  if (!changes) return;
  moved = !all.empty();
  bounds = all.empty() ? bounds_of(graph) : moved_bounds();
  stale();
  shadows.forget();
  deformed = true;
  deformation = summary_of(all);
  overlaps.reset();
  paths.set_moved();
  if (ground) ground->invalidate();
  report.reset();
}

void Engine::Implementation::add_overlaps(SolveReport& of) {
  if (!overlaps) {
    overlaps.emplace();
    const std::vector<Deformer> all = poses.empty() ? std::vector<Deformer>() : checked({}, poses);
    if (!all.empty() && !graph.levels().empty()) {
      if (!locator) locator.emplace(graph.levels()[0]);
      *overlaps = overlap_text(graph, all.front(), *locator);
    }
  }
  if (!overlaps->empty()) of.deformed += (of.deformed.empty() ? "" : "; ") + *overlaps;
}

}  // namespace quadgraph
