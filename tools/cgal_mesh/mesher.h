// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedra inside a closed surface by CGAL's Mesh_3; the only header-heavy translation unit is mesher.cpp.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "tools/cgal_mesh/sizing_field.h"

namespace quadgraph::cgal {

struct Options {
  double grading = 1.0;                                      // K of the sizing field
  double largest = std::numeric_limits<double>::infinity();  // mm, no size is above it
  double time_limit_s = 240;  // shared by the optimisers after refinement; they stop early rather than fail
};

struct Tets {
  std::vector<Point> vertices;           // mm, those on the surface first
  std::vector<std::array<int, 4>> tets;  // positively oriented
};

// Read the closed triangle surface of an OFF file and fill it. Progress goes to stderr.
// Throws std::runtime_error with the reason: unreadable, not closed, self-intersecting, or nothing made.
Tets mesh_surface(const std::string& off_path, const Options& options);

}  // namespace quadgraph::cgal
