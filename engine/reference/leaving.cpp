#include "engine/reference/leaving.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtx/component_wise.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "engine/optics/fresnel.h"
#include "engine/optics/surface_boundary.h"
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

// What of a share of at most `most` is followed through further parts of the body.
double followed(double most) {
  return glm::smoothstep(double{gpu::GATHER_END}, double{gpu::FOLLOWED_WHOLE}, most);
}

struct Branch {
  glm::dvec3 share, direction;
  Hit hit;
};

// Takes the branches that wait from the brightest on until one meets the body; of what goes past it, or is not
// followed, the share is added to `seen`.
std::optional<Branch> brightest_that_meets(const Level& level, std::vector<Escape>& waiting, glm::dvec3& seen) {
  const auto dimmer = [](const Escape& a, const Escape& b) { return glm::compMax(a.share) < glm::compMax(b.share); };
  while (!waiting.empty()) {
    const auto most = std::max_element(waiting.begin(), waiting.end(), dimmer);
    const Escape escape = *most;
    if (glm::compMax(escape.share) <= double{gpu::GATHER_END}) break;
    waiting.erase(most);
    const auto hit = first_met(level, escape.point, escape.direction, escape.face);
    const double share = hit && hit->outside ? followed(glm::compMax(escape.share)) : 0;
    seen += (1 - share) * escape.share;
    if (share > 0) return Branch{share * escape.share, escape.direction, *hit};
  }
  return std::nullopt;
}

}  // namespace

LeavingLight leaving(const Level& level, const Problem& problem, const InsideLight& light,
                     std::span<const VertexScale> scale, std::uint32_t f, glm::dvec3 barycentric, glm::dvec3 outside) {
  LeavingLight sum;
  glm::dvec3 share(1);
  std::vector<Escape> waiting;
  for (std::uint32_t part = 0; part < gpu::VIEW_PARTS; ++part) {
    const glm::dvec3 normal =
        part == 0 || light.normals.empty() ? frame_of(level, f).normal : normal_at(light.normals[f], barycentric);
    const double eta = problem.eta.behind(level, f), norm = radiance_norm(eta);
    share *= fresnel_transmittance(std::clamp(glm::dot(outside, normal), 0.0, 1.0), eta);
    const Gathered inside = gather(level, problem, light, f, barycentric, refract(-outside, normal, eta));
    glm::dvec3 factor(0), rest(0), least(0);
    for (int k = 0; k < 3; ++k) {
      factor += barycentric[k] * scale[level.faces[f][k]].factor;
      rest += barycentric[k] * scale[level.faces[f][k]].rest;
      least += barycentric[k] * scale[level.faces[f][k]].least;
    }
    const glm::dvec3 radiance = factor * inside.radiance / (eta * eta) + rest / norm;
    sum.radiance += share * glm::max(radiance, least / norm);
    for (Escape escape : inside.escapes) {
      escape.share *= share;
      waiting.push_back(escape);
    }
    share = glm::dvec3(0);
    const auto next = brightest_that_meets(level, waiting, sum.seen);
    if (!next) break;
    share = next->share;
    f = next->hit.face;
    barycentric = next->hit.barycentric;
    outside = -next->direction;
  }
  sum.seen += share;
  for (const Escape& escape : waiting) sum.seen += escape.share;
  return sum;
}

}  // namespace quadgraph
