#include "engine/solve/carried_correction.h"

#include <algorithm>
#include <cmath>

#include "engine/solve/mesh_error.h"
#include "engine/solve/moved_bytes.h"
#include "interface/surface/carried_exitance.comp.h"
#include "interface/surface/light_change.comp.h"

namespace quadgraph {
CarriedCorrection::CarriedCorrection(device::Device& device, const LevelBuffers& level) {
  const auto room = [&](std::uint64_t count, const char* name, device::Place place = device::Place::device) {
    return device::Buffer(device, count * vec3_bytes, place, "carried/" + std::string(name));
  };
  solved_ = room(level.face_count, "exitance of the solve");
  corrected_ = room(level.face_count, "exitance that was corrected");
  light_ = room(level.face_count, "light");
  overlap_ = room(1, "overlap of the light");
  overlap_on_host_ = room(1, "overlap of the light, read back", device::Place::host);
}

void CarriedCorrection::record_solved(Workspace& work, const LevelBuffers& level, const device::Buffer& exitance) {
  work.recorder.copy(exitance, solved_, solved_.size());
  work.recorder.copy(level.q, light_, light_.size());
}

void CarriedCorrection::record_corrected(Workspace& work, const device::Buffer& exitance) {
  work.recorder.copy(exitance, corrected_, corrected_.size());
}

void CarriedCorrection::keep_error(const SolveReport& report) {
  error_ = report.error;
  mesh_error_ = report.mesh_error;
  model_error_ = report.model_error;
  changed_ = report.correction->changed;
}

void CarriedCorrection::record(Workspace& work, const LevelBuffers& level, const device::Buffer& exitance,
                               double material) {
  const gpu::LightChangePush change{.vertices = level.vertices.address(),
                                    .faces = level.faces.address(),
                                    .q = level.q.address(),
                                    .q_before = light_.address(),
                                    .overlap = overlap_.address(),
                                    .reduction = work.reduction.address(),
                                    .count = level.face_count};
  work.recorder.dispatch(work.passes.of(shader::light_change), change, level.face_count, "carried correction",
                         level.face_count * (sizeof(glm::uvec3) + 5 * vec3_bytes));
  const gpu::CarriedExitancePush carried{.exitance = exitance.address(),
                                         .solved = solved_.address(),
                                         .corrected = corrected_.address(),
                                         .q = level.q.address(),
                                         .q_before = light_.address(),
                                         .overlap = overlap_.address(),
                                         .count = level.face_count,
                                         .same = static_cast<float>(material)};
  work.recorder.dispatch(work.passes.of(shader::carried_exitance), carried, level.face_count, "carried correction",
                         level.face_count * 6 * vec3_bytes);
  work.recorder.copy(overlap_, overlap_on_host_, overlap_.size());
}

void CarriedCorrection::state(SolveReport& report, double material) const {
  const glm::vec3 overlap = overlap_on_host_.mapped_as<glm::vec3>()[0];
  const double same = material * (overlap.y > 0 ? double{overlap.x} / double{overlap.y} : 1);
  report.carried = same;
  if (!error_) return;
  const auto left = [&](double known, double changed) { return std::hypot(known, (1 - same) * changed); };
  const auto together = [](double all, double part) { return std::hypot(all, part); };
  report.mesh_error = mesh_error_;
  report.model_error = by_parts(left, model_error_.value_or(ErrorEstimate{}), changed_);
  report.error = by_parts(left, by_parts(together, *error_, report.algebraic.value_or(ErrorEstimate{})), changed_);
}

}  // namespace quadgraph
