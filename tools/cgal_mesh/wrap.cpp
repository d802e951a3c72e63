// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cgal_mesh/wrap.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <cstddef>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <vector>

namespace quadgraph::cgal {

void wrap_surface(const std::string& off_path, const std::string& wrap_path, double alpha, double offset) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> faces;
  if (!CGAL::IO::read_OFF(off_path, points, faces) || faces.empty()) {
    throw std::runtime_error(off_path + ": cannot be read as OFF triangles");
  }
  CGAL::Surface_mesh<Kernel::Point_3> wrap;
  CGAL::alpha_wrap_3(points, faces, alpha, offset, wrap);
  std::ofstream file(wrap_path);
  file.precision(std::numeric_limits<double>::max_digits10);
  CGAL::IO::write_OFF(file, wrap);
  file.close();
  if (!file) throw std::runtime_error(wrap_path + ": cannot be written");
}

}  // namespace quadgraph::cgal
