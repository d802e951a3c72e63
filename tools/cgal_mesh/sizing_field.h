// SPDX-License-Identifier: GPL-3.0-or-later
// The sizing field of the QuadGraph paper (after Alliez et al. 2005).
#pragma once

#include <array>
#include <vector>

namespace quadgraph::cgal {

using Point = std::array<double, 3>;  // mm

// size(x) = min over surface samples s of (grading * |x - s| + local(s)), mm.
//
// Evaluated exactly, by branch and bound over a kd-tree that holds the smallest local size of each node. The field is
// Lipschitz with constant `grading`. Samples are the surface's vertices, local(s) the mean length of the edges there.
class SizingField {
 public:
  // One local size (mm, > 0) per sample; grading > 0. Throws std::invalid_argument for anything else.
  SizingField(std::vector<Point> samples, std::vector<double> local, double grading);

  double operator()(const Point& x) const;

 private:
  struct Node {
    Point low, high;   // box of its samples
    double min_local;  // smallest local size among them
    int begin, end;    // range of its samples
    int left, right;   // children, -1 in a leaf
  };

  int build(int begin, int end);
  double bound(const Node& node, const Point& x) const;
  void search(int node, const Point& x, double& best) const;

  std::vector<Point> samples_;
  std::vector<double> local_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
  double grading_;
};

}  // namespace quadgraph::cgal
