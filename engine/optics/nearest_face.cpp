#include "engine/optics/nearest_face.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace quadgraph {
namespace {

float squared(const glm::vec3& v) {
  return glm::dot(v, v);
}

float squared_distance_to_edge(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 ab = b - a;
  const float t = glm::clamp(glm::dot(p - a, ab) / std::max(squared(ab), 1e-20f), 0.0f, 1.0f);
  return squared(p - a - t * ab);
}

// To the face's plane where p lies above the face, else to the nearest edge.
float squared_distance(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 normal = glm::cross(b - a, c - a);
  const auto left_of = [&](const glm::vec3& from, const glm::vec3& to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
  };
  if (left_of(a, b) && left_of(b, c) && left_of(c, a)) {
    const float height = glm::dot(p - a, normal);
    return height * height / std::max(squared(normal), 1e-20f);
  }
  return std::min(
      {squared_distance_to_edge(p, a, b), squared_distance_to_edge(p, b, c), squared_distance_to_edge(p, c, a)});
}

}  // namespace

float NearestFace::Box::squared_distance(const glm::vec3& p) const {
  return squared(p - glm::clamp(p, low, high));
}

NearestFace::NearestFace(const Level& level) : level_(level), tree_(face_tree(level)), boxes_(2 * tree_.leaves()) {
  for (std::uint32_t leaf = 0; leaf < tree_.leaves(); ++leaf) {
    for (std::uint32_t k = tree_.leaf_begin[leaf]; k < tree_.leaf_begin[leaf + 1]; ++k) {
      const glm::uvec3& face = level.faces[tree_.order[k]];
      for (int corner = 0; corner < 3; ++corner) boxes_[tree_.leaves() + leaf].hold(level.vertices[face[corner]]);
    }
  }
  for (std::uint32_t node = tree_.leaves() - 1; node > 0; --node) {
    for (std::uint32_t child : {2 * node, 2 * node + 1}) {
      boxes_[node].hold(boxes_[child].low);
      boxes_[node].hold(boxes_[child].high);
    }
  }
}

NearestFace::Found NearestFace::find(const glm::vec3& point, std::optional<std::uint32_t> guess) const {
  Found nearest{.face = 0, .distance = std::numeric_limits<float>::max()};  // its square until all were looked at
  if (guess) look_at(*guess, point, nearest);
  descend(1, point, nearest);
  nearest.distance = std::sqrt(nearest.distance);
  return nearest;
}

void NearestFace::look_at(std::uint32_t face, const glm::vec3& p, Found& nearest) const {
  const glm::uvec3& f = level_.faces[face];
  const float distance = squared_distance(p, level_.vertices[f.x], level_.vertices[f.y], level_.vertices[f.z]);
  if (distance < nearest.distance) nearest = {.face = face, .distance = distance};
}

void NearestFace::descend(std::uint32_t node, const glm::vec3& p, Found& nearest) const {
  if (boxes_[node].squared_distance(p) >= nearest.distance) return;
  if (node >= tree_.leaves()) {
    const std::uint32_t leaf = node - tree_.leaves();
    for (std::uint32_t k = tree_.leaf_begin[leaf]; k < tree_.leaf_begin[leaf + 1]; ++k) {
      look_at(tree_.order[k], p, nearest);
    }
    return;
  }
  const bool right = boxes_[2 * node + 1].squared_distance(p) < boxes_[2 * node].squared_distance(p);
  descend(2 * node + (right ? 1 : 0), p, nearest);
  descend(2 * node + (right ? 0 : 1), p, nearest);
}

}  // namespace quadgraph
