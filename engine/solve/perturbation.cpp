#include "engine/solve/perturbation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/device/memory.h"
#include "engine/solve/moved_bytes.h"
#include "engine/solve/solver_choice.h"
#include "engine/solve/surface_parts.h"
#include "engine/solve/surface_results.h"
#include "interface/assemble/right_hand_side_given.comp.h"
#include "shaders/surface/surface_shared.h"

namespace quadgraph {
namespace {

// What is left of what a solve is to find, as a share of it, and its iterations at most, with cycles and without.
constexpr double changed_share_left = 0.05;
constexpr std::uint32_t most_changed_cycles = 6, most_changed_steps = 500;

}  // namespace

Perturbation::Perturbation(device::Device& device, const Level& level)
    : patch_(surface_patches(level, [&] { device.heed(); })) {
  const auto room = [&](std::uint64_t count, std::uint64_t bytes, const char* name) {
    return device::Buffer(device, count * bytes, device::Place::device, "perturbation/" + std::string(name));
  };
  given_ = room(level.vertex_count(), vec3_bytes, "load");
  load_ = room(level.vertex_count(), vec3_bytes, "b");
  change_ = room(level.vertex_count(), vec3_bytes, "change of fluence");
  phi_ = room(level.face_count(), vec3_bytes, "change of phi");
  exitance_ = room(level.face_count(), vec3_bytes, "change of the exitance");
  clip_ = room(1, sizeof(gpu::Clip), "clip");
}

// Leaves the exitance, too. The operator lends its rows and vectors; b and x of its own solution stay what they are.
void Perturbation::solve(const PerturbedSolution& solution, const Record& record) {
  Workspace& work = solution.work;
  OperatorBuffers& op = solution.operators.at(solution.key, 0);
  std::swap(op.b, load_);
  std::swap(op.x, change_);
  record(op);
  work.recorder.fill(op.x, 0);
  const SolverKind kind = possible_solver(solution.operators, solution.key, SolverKind::fmg_pcg).solver;
  const LevelTask task{.solver = kind,
                       .boundaries = solution.boundaries.on_device,
                       .tolerance = changed_share_left,
                       .max_iterations = rules_of(kind).cycles ? most_changed_cycles : most_changed_steps,
                       .smoothing = rules_of(kind).smoothing};
  LevelSolver solver(work, solution.operators, solution.key, 0, task);
  solver.run();
  record_exitance(work, {solution.level, op, Method::fem, solution.boundaries, nullptr}, phi_, exitance_, clip_);
  work.recorder.submit();
  std::swap(op.b, load_);
  std::swap(op.x, change_);
}

Perturbation::Record Perturbation::given(const PerturbedSolution& solution, std::span<const glm::vec3> load) {
  Workspace& work = solution.work;
  device::write_bytes(work.recorder.device(), given_, std::as_bytes(load));
  return [&](OperatorBuffers& op) {
    const gpu::RightHandSideGivenPush push{
        .load = given_.address(), .side = op.right_hand_side(work.reduction), .count = op.count};
    work.recorder.dispatch(work.passes.of(shader::right_hand_side_given, op.model, op.format), push, op.count,
                           "right-hand side", op.count * (op.block_bytes() + op.field_bytes() + vec3_bytes));
  };
}

std::vector<glm::vec3> Perturbation::exitance(const PerturbedSolution& solution, const Record& record) {
  solve(solution, record);
  return device::download<glm::vec3>(solution.work.recorder.device(), exitance_);
}

std::vector<glm::vec3> Perturbation::exitance(const PerturbedSolution& solution, std::span<const glm::vec3> load) {
  return exitance(solution, given(solution, load));
}

std::vector<glm::vec3> Perturbation::fluence(const PerturbedSolution& solution, std::span<const glm::vec3> load) {
  solve(solution, given(solution, load));
  return device::download<glm::vec3>(solution.work.recorder.device(), change_);
}

ErrorEstimate Perturbation::relative(const PerturbedSolution& solution, std::span<const glm::vec3> a,
                                     std::span<const glm::vec3> b, const glm::dvec3& counts) const {
  struct Patch {
    double area = 0;
    glm::dvec3 exitance{0}, a{0}, b{0};
  };
  const SurfaceField& field = solution.field;
  const Listener listener = [&] { solution.work.recorder.device().heed(); };
  const auto error_of = [&](const auto& taken) {
    std::vector<Patch> sums(most_patches);
    for (std::size_t f = 0; f < field.area.size(); ++f) {
      heed(listener, f);
      if (!taken(f)) continue;
      const double area = field.area[f];
      Patch& patch = sums[patch_[f]];
      patch.area += area;
      patch.exitance += area * glm::dvec3(field.exitance[f]);
      patch.a += area * counts * glm::dvec3(a[f]);
      patch.b += area * counts * glm::dvec3(b[f]);
    }
    double product = 0, square_a = 0, square_b = 0, size = 0, count = 0;
    for (const Patch& patch : sums) {
      if (patch.area == 0) continue;
      product += glm::dot(patch.a, patch.b) / patch.area;
      square_a += glm::dot(patch.a, patch.a) / patch.area;
      square_b += glm::dot(patch.b, patch.b) / patch.area;
      size += glm::dot(patch.exitance, patch.exitance) / patch.area;
      ++count;
    }
    if (!(size > 0)) return 0.0;
    return std::sqrt(std::max(product, std::sqrt(square_a * square_b / count)) / size);
  };
  const SurfaceParts parts = surface_parts(field, solution.unlit, listener);
  return {error_of([](std::size_t) { return true; }), error_of([&](std::size_t f) { return parts.unlit[f]; }),
          error_of([&](std::size_t f) { return parts.dimmest[f]; })};
}

}  // namespace quadgraph
