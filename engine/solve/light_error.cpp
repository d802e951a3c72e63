#include "engine/solve/light_error.h"

#include <cmath>

namespace quadgraph {
glm::dvec3 share_of_surface_light(const Energy& energy, double k11, std::span<const gpu::Optical> optical) {
  glm::dvec3 sigma_a{0}, sigma_t{0};  // sums
  for (const gpu::Optical& at : optical) {
    sigma_a += glm::dvec3(at.sigma_a);
    sigma_t += glm::dvec3(at.sigma_a) + glm::dvec3(at.sigma_s_prime);
  }
  glm::dvec3 share{0};
  for (int c = 0; c < 3; ++c) {
    if (!(energy.entered[c] > 0)) continue;
    const double inwards = sigma_t[c] > 0 ? std::sqrt(sigma_a[c] / (3 * sigma_t[c])) : 0;  // flux over phi
    share[c] = energy.scattered_out[c] / energy.entered[c] * (1 + inwards / k11);
  }
  return share;
}

void add_light_error(SolveReport& report, const ErrorEstimate& light) {
  report.light_error = light;
  if (!report.error) return;
  report.error = by_parts([](double all, double part) { return std::hypot(all, part); }, *report.error, light);
}

LightError::LightError(device::Device& device, const Level& level)
    : difference_(device, samples * level.face_count() * sizeof(glm::vec3), device::Place::device,
                  "light error/difference") {}

ErrorEstimate LightError::estimate(Perturbation& perturbation, const PerturbedSolution& solution,
                                   const glm::dvec3& share) const {
  const auto change = [&](std::uint32_t sample) {
    const std::uint64_t q = difference_.address() + sample * solution.level.face_count * sizeof(glm::vec3);
    return perturbation.exitance(
        solution, [&](OperatorBuffers& op) { record_surface_load(solution.work, solution.level, q, op); });
  };
  const std::vector<glm::vec3> a = change(0), b = change(1);
  return perturbation.relative(solution, a, b, share);
}

}  // namespace quadgraph
