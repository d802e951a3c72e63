// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cgal_mesh/sizing_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace quadgraph::cgal {
namespace {

constexpr int kLeafSize = 8;

double distance(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace

SizingField::SizingField(std::vector<Point> samples, std::vector<double> local, double grading)
    : samples_(std::move(samples)), local_(std::move(local)), order_(samples_.size()), grading_(grading) {
  const auto usable = [](double size) { return std::isfinite(size) && size > 0; };
  if (samples_.empty() || samples_.size() != local_.size() || !usable(grading) ||
      !std::all_of(local_.begin(), local_.end(), usable)) {
    throw std::invalid_argument(
        "sizing field: needs samples, one finite local size above 0 each, and a grading above 0");
  }
  std::iota(order_.begin(), order_.end(), 0);
  build(0, static_cast<int>(order_.size()));
}

int SizingField::build(int begin, int end) {
  Node node{samples_[order_[begin]], samples_[order_[begin]], local_[order_[begin]], begin, end, -1, -1};
  for (int i = begin; i < end; ++i) {
    const Point& p = samples_[order_[i]];
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis] = std::min(node.low[axis], p[axis]);
      node.high[axis] = std::max(node.high[axis], p[axis]);
    }
    node.min_local = std::min(node.min_local, local_[order_[i]]);
  }
  const int index = static_cast<int>(nodes_.size());
  nodes_.push_back(node);
  if (end - begin <= kLeafSize) return index;

  int widest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (node.high[axis] - node.low[axis] > node.high[widest] - node.low[widest]) widest = axis;
  }
  const int middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](int a, int b) { return samples_[a][widest] < samples_[b][widest]; });
  const int left = build(begin, middle);
  const int right = build(middle, end);
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

double SizingField::bound(const Node& node, const Point& x) const {
  Point nearest;
  for (int axis = 0; axis < 3; ++axis) nearest[axis] = std::clamp(x[axis], node.low[axis], node.high[axis]);
  return grading_ * distance(x, nearest) + node.min_local;
}

void SizingField::search(int index, const Point& x, double& best) const {
  const Node& node = nodes_[index];
  if (node.left < 0) {
    for (int i = node.begin; i < node.end; ++i) {
      best = std::min(best, grading_ * distance(x, samples_[order_[i]]) + local_[order_[i]]);
    }
    return;
  }
  std::array<std::pair<double, int>, 2> children = {std::pair{bound(nodes_[node.left], x), node.left},
                                                    std::pair{bound(nodes_[node.right], x), node.right}};
  if (children[1].first < children[0].first) std::swap(children[0], children[1]);
  for (const auto& [least, child] : children) {
    if (least < best) search(child, x, best);
  }
}

double SizingField::operator()(const Point& x) const {
  double best = std::numeric_limits<double>::infinity();
  search(0, x, best);
  return best;
}

}  // namespace quadgraph::cgal
