// SPDX-License-Identifier: GPL-3.0-or-later
// A closed surface around triangles of any kind by CGAL's Alpha_wrap_3.
#pragma once

#include <string>

namespace quadgraph::cgal {

// Reads the triangles of an OFF file, which may be open, cross each other or hang together in any way, and writes a
// closed 2-manifold without crossings around them as OFF, `offset` away: holes narrower than `alpha` are covered, and
// no edge is much longer. Throws std::runtime_error with the reason: unreadable, or cannot be written.
void wrap_surface(const std::string& off_path, const std::string& wrap_path, double alpha, double offset);

}  // namespace quadgraph::cgal
