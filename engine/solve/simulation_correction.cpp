// The transport correction as a part of a solve.
#include <cmath>

#include "engine/solve/simulation_implementation.h"

namespace quadgraph {
namespace {

// How much indices differ from those before, by body, the most of any; 1 where there were none, or they
// are finished otherwise.
double index_change(std::span<const OpticalSurface> before, std::span<const OpticalSurface> now) {
  double most = before.empty() ? 1 : 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double change = std::abs(now[i].eta - before[i].eta) / now[i].eta;
    most = std::max(most, static_cast<const Finish&>(now[i]) == before[i] ? change : 1);
  }
  return most;
}

}  // namespace

void Simulation::Implementation::correction_room(std::uint32_t points) {
  operators.rounded(correction_key, coefficients.packed_rounding(correction_key.model));
  operators.create(device, shape.levels(), correction_key, coefficients.even(), false);
  if (!correction) correction.emplace(device, shape.levels()[0]);
  if (!carried) carried.emplace(device, levels[0]);
  correction->make_room(device, points);
  gather_room().make_room_corrected(device, shape.levels()[0]);
  if (!goes_forward()) return;
  correction->make_room_forward(device, shape.levels()[0]);
  gather->make_room_forward(device, shape.levels()[0]);
}

void Simulation::Implementation::with_solution(const BodyBoundaries& boundaries,
                                               const std::function<void(const PerturbedSolution&)>& use) {
  SurfaceField field = surface_of(shape.present(device, levels[0]));
  field.q = device::download<glm::vec3>(device, levels[0].q);
  field.exitance = device::download<glm::vec3>(device, results.exitance());
  use({.work = work,
       .level = levels[0],
       .operators = operators,
       .key = correction_key,
       .boundaries = boundaries,
       .field = field,
       .unlit = device::download<gpu::Scale>(device, work.scale)[0].unlit});
}

CorrectedPatches Simulation::Implementation::measure_patches(const BodyBoundaries& boundaries) {
  auto [a, b] = correction->exitance_by_halves(device);
  std::vector<glm::vec3> noise(a.size());
  CorrectedPatches patches;
  with_solution(boundaries, [&](const PerturbedSolution& solution) {
    for (std::size_t f = 0; f < noise.size(); ++f) {
      noise[f] = 0.5f * (a[f] - b[f]);
      a[f] -= solution.field.exitance[f];
      b[f] -= solution.field.exitance[f];
    }
    patches = {.change = perturbation->relative(solution, a, b, glm::dvec3(1)),
               .noise = perturbation->relative(solution, noise, noise, glm::dvec3(1))};
  });
  return patches;
}

double Simulation::Implementation::material_change(std::span<const gpu::Optical> now) const {
  return std::max(extinction_change(corrected_optical, now), index_change(corrected_surfaces, refractions.surfaces()));
}

void Simulation::Implementation::forget_other_material() {
  if (!optical_changed) return;
  std::vector<gpu::Optical> now = optical_at(0);
  const bool another = material_change(now) > most_carried;
  another || goes_forward() || corrected_g != coefficients.angles().g ? correction->forget() : correction->edited();
  corrected_optical = std::move(now);
  corrected_g = coefficients.angles().g;
  corrected_surfaces.assign(refractions.surfaces().begin(), refractions.surfaces().end());
  optical_changed = false;
}

void Simulation::Implementation::prepare_correction(const BodyBoundaries& boundaries) {
  for (std::uint32_t i = 0; i < operators.count(correction_key); ++i) {
    OperatorBuffers& op = operators.at(correction_key, i);
    record_rows(work, levels[i], Method::fem, boundaries, coefficients.even(), StepBound::majorant, op);
    if (!op.weighed) record_surface_share(work, levels[i], Method::fem, boundaries, op);
    op.weighed = true;
  }
}

void Simulation::Implementation::correct(const OperatorKey& key, const SolveOptions& options, const Check& check,
                                         SolveReport& report) {
  const BodyBoundaries& boundaries = correction_boundaries();
  prepare_correction(boundaries);
  forget_other_material();
  const Solved of_solve{levels[0],   operators.at(key, 0),
                        Method::fem, refractions.boundaries(Method::fem, Source::buried, key.model),
                        &walks[0],   goes_forward() ? correction->forward().leaving().address() : 0};
  const TransportParts transport{
      work, levels[0], beams, walks[0], gather->nearest(), *tree, report.inter_reflection, coefficients.angles().g};
  const CorrectionParts parts{
      transport, operators, boundaries, of_solve, results, resolution_with(key.model).front().slow, check};
  carried->forget();
  carried->record_solved(work, levels[0], results.exitance());
  report.correction = correction->run(parts, options, {Method::fem, coefficients.even(), options.mean_rays});
  if (!options.warm) take_patches(*report.correction, measure_patches(boundaries), options);
  results.record_corrected(work, of_solve, correction->fluence(), correction->exitance(), report.correction->taken);
  correction->record_taken(parts, *report.correction);
  carried->record_corrected(work, results.exitance());
  work.recorder.submit();
  carried->keep(key);
  report.energy = results.energy();
  const TransportPower power = correction->power(glm::dvec3(scale()), report.energy.scattered_out);
  report.energy.entered = power.entered;
  report.energy.absorbed += power.absorbed;
  report.energy.unscattered_out = power.unscattered;
  report.energy.re_entered = power.entered_again;
  report.clipped = results.clipped();
  state_corrected_error(report, resolution_with(key.model).front().corrected, options.mean_of);
  state_missed(report, options.error);
  report.model_warning.clear();
}

void Simulation::Implementation::carry(const OperatorKey& key, const SolveOptions& options, SolveReport& report) {
  if (!carried || !carried->knows(key)) return;
  const double material = optical_changed ? std::max(0.0, 1 - material_change(optical_at(0))) : 1;
  carried->record(work, levels[0], results.exitance(), material);
  results.record_shown(
      work, {levels[0], operators.at(key, 0), key.method, refractions.boundaries(key.method, options.source, key.model),
             options.source == Source::buried ? &walks[0] : nullptr});
  work.recorder.submit();
  carried->state(report, material);
  report.model_warning.clear();
}

}  // namespace quadgraph
