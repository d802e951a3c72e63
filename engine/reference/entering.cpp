#include "engine/reference/entering.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "engine/optics/fresnel.h"
#include "shaders/shared/random.h"

namespace quadgraph {
namespace {

// A unit vector in face f whose angle with its first edge is GOLDEN_TURN times f.
glm::dvec3 tangent_of(const FaceFrame& frame, std::uint32_t f) {
  const glm::dvec3 t1 = glm::normalize(frame.corners[1] - frame.corners[0]), t2 = glm::cross(frame.normal, t1);
  const std::uint32_t turn = f * gpu::GOLDEN_TURN;
  const double azimuth = glm::two_pi<double>() * turn / 4294967296.0;
  return std::cos(azimuth) * t1 + std::sin(azimuth) * t2;
}

}  // namespace

FaceFrame frame_of(const Level& level, std::uint32_t f) {
  FaceFrame frame;
  for (int k = 0; k < 3; ++k)
    frame.corners[static_cast<std::size_t>(k)] = glm::dvec3(level.vertices[level.faces[f][k]]);
  const glm::dvec3 n = glm::cross(frame.corners[1] - frame.corners[0], frame.corners[2] - frame.corners[0]);
  frame.normal = glm::normalize(n);
  frame.area = 0.5 * glm::length(n);
  return frame;
}

glm::dvec3 point_at(const FaceFrame& frame, const glm::dvec3& barycentric) {
  return barycentric[0] * frame.corners[0] + barycentric[1] * frame.corners[1] + barycentric[2] * frame.corners[2];
}

glm::dvec3 refract(const glm::dvec3& outside, const glm::dvec3& n, double eta) {
  const double cos_i = std::max(-glm::dot(outside, n), 0.0);
  return glm::normalize(outside / eta + (cos_i / eta - refracted_cosine(cos_i, eta)) * n);
}

double refracted_cosine(double outside, double eta) {
  return std::sqrt(1.0 - (1.0 - outside * outside) / (eta * eta));
}

double LambertianBundle::mean_cosine() const {
  double mean = 0;
  for (std::size_t k = 0; k < mu.size(); ++k) mean += share[k] * mu[k];
  return mean;
}

LambertianBundle lambertian_bundle(double eta) {
  LambertianBundle bundle;
  double sum = 0;
  for (std::size_t k = 0; k < bundle.mu.size(); ++k) {
    const double outside = std::sqrt(static_cast<double>(gpu::LAMBERTIAN_U[k]));
    bundle.mu[k] = refracted_cosine(outside, eta);
    bundle.share[k] = static_cast<double>(gpu::LAMBERTIAN_W[k]) * fresnel_transmittance(outside, eta);
    sum += bundle.share[k];
  }
  for (double& share : bundle.share) share /= sum;
  return bundle;
}

std::array<glm::dvec3, 2 * gpu::LAMBERTIAN_NODES> lambertian_directions(const FaceFrame& frame, std::uint32_t f,
                                                                        double eta) {
  const glm::dvec3 t1 = tangent_of(frame, f), t2 = glm::cross(frame.normal, t1);
  std::array<glm::dvec3, 2 * gpu::LAMBERTIAN_NODES> directions;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const std::size_t k = i / 2;
    const double u = static_cast<double>(gpu::LAMBERTIAN_U[k]);
    const glm::dvec3 across = std::sqrt(1.0 - u) * (k % 2 == 0 ? t1 : t2);
    directions[i] = refract((i % 2 == 0 ? 1.0 : -1.0) * across - std::sqrt(u) * frame.normal, frame.normal, eta);
  }
  return directions;
}

glm::dvec3 mean_direction(const FaceFrame& frame, std::uint32_t f, double eta) {
  const double mu = lambertian_bundle(eta).mean_cosine();
  return std::sqrt(1.0 - mu * mu) * tangent_of(frame, f) - mu * frame.normal;
}

glm::dvec3 rectangle_incoming(const gpu::BeamRecord& beam, const FaceFrame& frame, std::uint32_t f,
                              std::uint32_t quarter, const glm::dvec3& point, double eta) {
  constexpr std::uint32_t side = gpu::RECTANGLE_SIDE;
  const glm::dvec3 centre(beam.travel_or_from), u(beam.u), v(beam.v);
  const auto to = [&](double x, double y) { return centre + (x / side - 0.5) * u + (y / side - 0.5) * v - point; };
  std::array<double, side * side> sums{};  // of what the parts up to each let in
  double all = 0;
  for (std::uint32_t k = 0; k < side * side; ++k) {
    const glm::dvec3 way = to(k % side + 0.5, k / side + 0.5);
    const double distance = glm::length(way), cosine = std::max(glm::dot(frame.normal, way) / distance, 0.0);
    const double sent = std::max(-glm::dot(glm::cross(u, v), way), 0.0) / (distance * distance * distance);
    all += sent * cosine * fresnel_transmittance(std::min(cosine, 1.0), eta);
    sums[k] = all;
  }
  if (all == 0) return glm::normalize(point - centre);
  const auto number = [&](std::uint32_t dimension) {
    return static_cast<double>(gpu::spread_number(0, 4 * f + quarter, dimension));
  };
  const auto drawn = std::upper_bound(sums.begin(), sums.end() - 1, number(0) * all);
  const auto k = static_cast<std::uint32_t>(drawn - sums.begin());
  return -glm::normalize(to(k % side + number(1), k / side + number(2)));
}

}  // namespace quadgraph
