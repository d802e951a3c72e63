#include "engine/solve/body_shape.h"

#include <algorithm>

namespace quadgraph {

BodyShape::BodyShape(const QuadGraph& graph, const Listener& listener) : moved_(graph), deformed_(graph.levels()) {
  sample();
  for (const Level& level : levels()) edge_shares_.push_back(inside_edge(level, listener) / chord_);
}

void BodyShape::sample() {
  samples_.clear();
  for (const Level& level : levels()) samples_.push_back(surface_samples(level));
  chord_ = mean_chord(levels()[0]);
}

const Level& BodyShape::present(device::Device& device, const LevelBuffers& finest) {
  if (deformed_.list().empty()) return levels()[0];
  if (!present_) {
    present_.emplace(moved_);
    present_->place(0, device::download<glm::vec3>(device, finest.vertices));
  }
  return present_->levels()[0];
}

void BodyShape::move(std::uint32_t number, std::span<const glm::vec3> positions) {
  moved_.move(number, positions);
  samples_[number] = surface_samples(levels()[number]);
  if (number == 0) chord_ = mean_chord(levels()[0]);
  set_ = true;
  present_.reset();
}

void BodyShape::put_back(device::Device& device, std::vector<LevelBuffers>& levels) {
  moved_.put_back();
  deformed_.put_back(device, levels);
  set_ = false;
  spoilt_.clear();
  present_.reset();
  sample();
}

bool BodyShape::is(std::span<const Deformer> list) const {
  return !set_ && std::equal(list.begin(), list.end(), deformed_.list().begin(), deformed_.list().end());
}

ShapeChange BodyShape::record(Workspace& work, std::span<const Deformer> list, const RestBox& box,
                              std::vector<LevelBuffers>& levels) {
  const ShapeChange change = change_between(deformed_.list(), list);
  deformed_.record(work, list, box, levels);
  present_.reset();
  return change;
}

ShapeState BodyShape::measured(std::uint32_t number) {
  ShapeState state = deformed_.state(number);
  samples_[number] = std::move(state.samples);
  if (number == 0) {
    chord_ = state.chord;
    spoilt_ = deformed_text(state);
  }
  return state;
}

void BodyShape::record_nodes(Workspace& work, std::uint32_t number, const LevelBuffers& level) {
  if (!deformed_.list().empty()) deformed_.record_nodes(work, number, level);
}

}  // namespace quadgraph
