#include "engine/scene/body_surface.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

#include "engine/base/error.h"
#include "engine/file/geometry.h"

namespace quadgraph {
namespace {

constexpr double sharp = 0.766;  // cosine of 40 degrees

// Of the corners of a triangle, at the place of it that is nearest to p [Ericson 2005, 5.1.5].
glm::dvec3 nearest_weights(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  return sum > 0 ? glm::dvec3(va, vb, vc) / sum : glm::dvec3(1, 0, 0);
}

Level shown_surface(const QuadGraph& body) {
  Level shown;
  if (!body.levels().empty()) return shown;
  shown.vertices = body.display().vertices;
  shown.faces = body.display().triangles;
  return shown;
}

}  // namespace

BodySurface::BodySurface(const QuadGraph& body)
    : shown_(shown_surface(body)), level_(body.levels().empty() ? shown_ : body.levels().front()) {
  if (level_.faces.empty()) throw InputError("body: no surface found, one with faces is wanted");
  low_ = glm::dvec3(std::numeric_limits<double>::max());
  high_ = -low_;
  begin_.assign(level_.vertices.size() + 1, 0);
  for (const glm::uvec3& face : level_.faces) {
    normals_.push_back(unit(face_vector(level_, face)));
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 place(level_.vertices[face[k]]);
      low_ = glm::min(low_, place);
      high_ = glm::max(high_, place);
      ++begin_[face[k] + 1];
    }
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  about_.resize(3 * level_.faces.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t f = 0; f < level_.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) about_[next[level_.faces[f][k]]++] = f;
  }
  for (std::uint32_t f = 0; f < level_.face_count(); ++f) {
    glm::dmat3 at;
    for (int k = 0; k < 3; ++k) {
      at[k] = around(level_.faces[f][k], [&](std::uint32_t g) { return glm::dot(normals_[f], normals_[g]) >= sharp; });
    }
    corners_.push_back(at);
  }
  for (std::uint32_t v = 0; v < level_.vertices.size(); ++v) smooth_.push_back(around(v, [](auto) { return true; }));
  nearest_ = std::make_unique<NearestFace>(level_);
}

// The mean of the normals of the faces about a vertex that count, by their angles there: at a vertex the one that tells
// inside from outside [Bærentzen 2005].
template <typename Counts>
glm::dvec3 BodySurface::around(std::uint32_t vertex, const Counts& counts) const {
  glm::dvec3 sum(0);
  for (std::uint32_t i = begin_[vertex]; i < begin_[vertex + 1]; ++i) {
    const std::uint32_t f = about_[i];
    if (!counts(f)) continue;
    const glm::uvec3& face = level_.faces[f];
    const int k = face.x == vertex ? 0 : face.y == vertex ? 1 : 2;
    const glm::dvec3 p(level_.vertices[vertex]);
    const glm::dvec3 a = unit(glm::dvec3(level_.vertices[face[(k + 1) % 3]]) - p),
                     b = unit(glm::dvec3(level_.vertices[face[(k + 2) % 3]]) - p);
    sum += std::acos(glm::clamp(glm::dot(a, b), -1.0, 1.0)) * normals_[f];
  }
  return unit(sum);
}

SurfacePlace BodySurface::find(const glm::dvec3& point, std::optional<std::uint32_t> guess) const {
  SurfacePlace place;
  place.face = nearest_->find(glm::vec3(point), guess).face;
  const glm::uvec3& f = level_.faces[place.face];
  const glm::dvec3 a(level_.vertices[f.x]), b(level_.vertices[f.y]), c(level_.vertices[f.z]);
  place.weights = nearest_weights(point, a, b, c);
  place.point = place.weights.x * a + place.weights.y * b + place.weights.z * c;
  const glm::dvec3 out = point - place.point;
  place.depth = glm::dot(out, pseudo_normal(place)) > 0 ? -glm::length(out) : glm::length(out);
  return place;
}

// That of the face, on an edge of both of its faces, on a vertex of all of its faces.
glm::dvec3 BodySurface::pseudo_normal(const SurfacePlace& place) const {
  const glm::uvec3& f = level_.faces[place.face];
  std::vector<std::uint32_t> on;
  for (int k = 0; k < 3; ++k) {
    if (place.weights[k] > 1e-9) on.push_back(f[k]);
  }
  if (on.size() == 3) return normals_[place.face];
  if (on.size() == 1) return smooth_[on.front()];
  glm::dvec3 sum(0);
  for (std::uint32_t i = begin_[on[0]]; i < begin_[on[0] + 1]; ++i) {
    const glm::uvec3& face = level_.faces[about_[i]];
    if (face.x == on[1] || face.y == on[1] || face.z == on[1]) sum += normals_[about_[i]];
  }
  return sum;
}

glm::dvec3 BodySurface::creased_normal(const SurfacePlace& place) const {
  return unit(corners_[place.face] * place.weights);
}

glm::dvec3 BodySurface::smooth_normal(const SurfacePlace& place) const {
  const glm::uvec3& f = level_.faces[place.face];
  return unit(place.weights.x * smooth_[f.x] + place.weights.y * smooth_[f.y] + place.weights.z * smooth_[f.z]);
}

double BodySurface::volume() const {
  double sum = 0;
  for (const glm::uvec3& f : level_.faces) {
    const glm::dvec3 a(level_.vertices[f.x]), b(level_.vertices[f.y]), c(level_.vertices[f.z]);
    sum += glm::dot(a - low_, glm::cross(b - low_, c - low_));
  }
  return sum / 6;
}

BodySurface::Topology BodySurface::topology() const {
  std::vector<std::uint32_t> root(level_.vertices.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find_root = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const glm::uvec3& f : level_.faces) {
    for (int k = 1; k < 3; ++k) root[find_root(f[k])] = find_root(f[0]);
  }
  Topology found;
  long vertices = 0;
  for (std::uint32_t v = 0; v < root.size(); ++v) {
    if (begin_[v] == begin_[v + 1]) continue;
    ++vertices;
    if (find_root(v) == v) ++found.pieces;
  }
  // Of a closed surface V - E + F = 2 (pieces - handles), with three edges to two faces.
  found.handles = static_cast<long>(found.pieces) - (vertices - static_cast<long>(level_.faces.size()) / 2) / 2;
  return found;
}

}  // namespace quadgraph
