#include "engine/reference/leaving.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtx/component_wise.hpp>
#include <limits>
#include <optional>

#include "engine/optics/fresnel.h"
#include "engine/reference/entering.h"
#include "shaders/gather/gather_shared.h"

namespace quadgraph {
namespace {

struct Hit {
  std::uint32_t face = 0;
  glm::dvec3 barycentric{0};
  bool outside = false;  // seen from its outside
};

// The first face but `own` on the way (Moeller and Trumbore 1997).
std::optional<Hit> first_met(const Level& level, const glm::dvec3& origin, const glm::dvec3& way, std::uint32_t own) {
  std::optional<Hit> first;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (f == own) continue;
    const FaceFrame frame = frame_of(level, f);
    const glm::dvec3 ab = frame.corners[1] - frame.corners[0], ac = frame.corners[2] - frame.corners[0];
    const glm::dvec3 p = glm::cross(way, ac), s = origin - frame.corners[0], q = glm::cross(s, ab);
    const double det = glm::dot(ab, p);
    if (det == 0) continue;
    const double u = glm::dot(s, p) / det, v = glm::dot(way, q) / det, t = glm::dot(ac, q) / det;
    if (u < 0 || v < 0 || u + v > 1 || t <= 0 || t >= nearest) continue;
    nearest = t;
    first = Hit{f, {1 - u - v, u, v}, det > 0};
  }
  return first;
}

}  // namespace

LeavingLight leaving(const Level& level, const Problem& problem, const InsideLight& light,
                     std::span<const VertexScale> scale, double radiance_norm, std::uint32_t f, glm::dvec3 barycentric,
                     glm::dvec3 outside) {
  LeavingLight sum;
  glm::dvec3 share(1);
  for (std::uint32_t part = 0; part < gpu::VIEW_PARTS; ++part) {
    const glm::dvec3 normal = frame_of(level, f).normal;
    share *= fresnel_transmittance(std::clamp(glm::dot(outside, normal), 0.0, 1.0), problem.eta);
    const Gathered inside = gather(level, problem, light, f, barycentric, refract(-outside, normal, problem.eta));
    glm::dvec3 factor(0), rest(0), least(0);
    for (int k = 0; k < 3; ++k) {
      factor += barycentric[k] * scale[level.faces[f][k]].factor;
      rest += barycentric[k] * scale[level.faces[f][k]].rest;
      least += barycentric[k] * scale[level.faces[f][k]].least;
    }
    const glm::dvec3 radiance = factor * inside.radiance / (problem.eta * problem.eta) + rest / radiance_norm;
    sum.radiance += share * glm::max(radiance, least / radiance_norm);
    sum.seen += share * (inside.seen - inside.escape.share);
    share *= inside.escape.share;
    if (glm::compMax(share) <= double{gpu::GATHER_END}) break;
    const auto hit = first_met(level, inside.escape.point, inside.escape.direction, inside.escape.face);
    if (!hit || !hit->outside) break;
    f = hit->face;
    barycentric = hit->barycentric;
    outside = -inside.escape.direction;
  }
  sum.seen += share;
  return sum;
}

}  // namespace quadgraph
