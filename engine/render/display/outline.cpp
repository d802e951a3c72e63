#include "engine/render/display/outline.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "engine/render/display/pick.h"

namespace quadgraph {
namespace {

constexpr int rows = 400, most_columns = 4000;

// Which cells of a picture are covered; cell (0, 0) at the lower left.
class Cover {
 public:
  explicit Cover(float aspect)
      : columns_(std::clamp(static_cast<int>(std::lround(aspect * rows)), 1, most_columns)),
        covered_(static_cast<std::size_t>(columns_) * rows) {}

  int columns() const { return columns_; }

  bool at(int column, int row) const {
    const bool inside = column >= 0 && row >= 0 && column < columns_ && row < rows;
    return inside && covered_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                              static_cast<std::size_t>(column)];
  }

  // Cells whose middle lies in the triangle, and those of its corners, so that narrow ones leave no gaps.
  void add(const std::array<glm::vec2, 3>& clip) {
    std::array<glm::vec2, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = glm::vec2(0.5f * (1 + clip[k].x) * static_cast<float>(columns_), 0.5f * (1 + clip[k].y) * rows);
      put(static_cast<int>(std::floor(p[k].x)), static_cast<int>(std::floor(p[k].y)));
    }
    const glm::vec2 low = glm::max(glm::floor(glm::min(p[0], glm::min(p[1], p[2]))), glm::vec2(0));
    const glm::vec2 high = glm::min(glm::max(p[0], glm::max(p[1], p[2])), glm::vec2(columns_ - 1, rows - 1));
    for (int row = static_cast<int>(low.y); row <= static_cast<int>(high.y); ++row) {
      for (int column = static_cast<int>(low.x); column <= static_cast<int>(high.x); ++column) {
        if (holds(p, glm::vec2(column + 0.5f, row + 0.5f))) put(column, row);
      }
    }
  }

  // Of the line between middles of cells that are covered and of those that are not, clip coordinates.
  glm::vec2 clip(float column, float row) const {
    return {2 * (column + 0.5f) / static_cast<float>(columns_) - 1, 2 * (row + 0.5f) / rows - 1};
  }

 private:
  static bool holds(const std::array<glm::vec2, 3>& p, const glm::vec2& at) {
    const auto side = [&](const glm::vec2& a, const glm::vec2& b) {
      return (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
    };
    const float a = side(p[0], p[1]), b = side(p[1], p[2]), c = side(p[2], p[0]);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
  }

  void put(int column, int row) {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows) return;
    covered_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)] =
        true;
  }

  int columns_;
  std::vector<bool> covered_;
};

// The edge within the square between the middles of four cells, by marching squares.
void add_square(const Cover& cover, int column, int row, std::vector<Segment>& segments) {
  const auto x = static_cast<float>(column), y = static_cast<float>(row);
  const std::array<bool, 4> in{cover.at(column, row), cover.at(column + 1, row), cover.at(column + 1, row + 1),
                               cover.at(column, row + 1)};
  const std::array<glm::vec2, 4> sides{cover.clip(x + 0.5f, y), cover.clip(x + 1, y + 0.5f),
                                       cover.clip(x + 0.5f, y + 1), cover.clip(x, y + 0.5f)};
  std::array<glm::vec2, 4> crossed;
  std::size_t count = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (in[k] != in[(k + 1) % 4]) crossed[count++] = sides[k];
  }
  for (std::size_t k = 0; k + 1 < count; k += 2) segments.push_back({crossed[k], crossed[k + 1]});
}

}  // namespace

std::vector<Segment> outline_of(const QuadGraph& graph, std::span<const glm::vec3> vertices, std::uint32_t body,
                                const Camera& camera, float aspect) {
  Cover cover(aspect);
  const auto& triangles = graph.display().triangles;
  for (std::uint32_t number = 0; number < triangles.size(); ++number) {
    if (body_of({.triangle = number}, graph) != body) continue;
    std::array<glm::vec2, 3> corners;
    bool before = true;  // the eye
    for (int k = 0; k < 3; ++k) {
      const glm::vec4 clip = camera.clip(vertices[triangles[number][k]]);
      before = before && clip.w > 0;
      corners[static_cast<std::size_t>(k)] = glm::clamp(glm::vec2(clip.x, clip.y) / clip.w, -4.0f, 4.0f);
    }
    if (before) cover.add(corners);
  }
  std::vector<Segment> segments;
  for (int row = -1; row < rows; ++row) {
    for (int column = -1; column < cover.columns(); ++column) add_square(cover, column, row, segments);
  }
  return segments;
}

}  // namespace quadgraph
