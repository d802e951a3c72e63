#include "engine/optics/depth.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <thread>

#include "engine/file/face_tree.h"

namespace quadgraph {
namespace {

struct Box {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};

  void hold(const glm::vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

float squared(const glm::vec3& v) {
  return glm::dot(v, v);
}

float squared_distance(const Box& box, const glm::vec3& p) {
  return squared(p - glm::clamp(p, box.low, box.high));
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

class Surface {
 public:
  explicit Surface(const Level& level) : level_(level), tree_(face_tree(level)), boxes_(2 * tree_.leaves()) {
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

  float distance(const glm::vec3& p) const {
    float nearest = std::numeric_limits<float>::max();
    descend(1, p, nearest);
    return std::sqrt(nearest);
  }

 private:
  void descend(std::uint32_t node, const glm::vec3& p, float& nearest) const {
    if (squared_distance(boxes_[node], p) >= nearest) return;
    if (node >= tree_.leaves()) {
      const std::uint32_t leaf = node - tree_.leaves();
      for (std::uint32_t k = tree_.leaf_begin[leaf]; k < tree_.leaf_begin[leaf + 1]; ++k) {
        const glm::uvec3& f = level_.faces[tree_.order[k]];
        nearest =
            std::min(nearest, squared_distance(p, level_.vertices[f.x], level_.vertices[f.y], level_.vertices[f.z]));
      }
      return;
    }
    const bool right = squared_distance(boxes_[2 * node + 1], p) < squared_distance(boxes_[2 * node], p);
    descend(2 * node + (right ? 1 : 0), p, nearest);
    descend(2 * node + (right ? 0 : 1), p, nearest);
  }

  const Level& level_;
  FaceTree tree_;
  std::vector<Box> boxes_;
};

}  // namespace

std::vector<float> depth_below_surface(const Level& level, std::span<const glm::vec3> points) {
  const Surface surface(level);
  std::vector<float> depth(points.size());
  const std::size_t workers = std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::jthread> threads;
  for (std::size_t w = 0; w < workers; ++w) {
    threads.emplace_back([&, w] {
      const std::size_t first = points.size() * w / workers, last = points.size() * (w + 1) / workers;
      for (std::size_t i = first; i < last; ++i) depth[i] = surface.distance(points[i]);
    });
  }
  threads.clear();
  return depth;
}

}  // namespace quadgraph
