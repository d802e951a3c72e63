// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cgal_mesh/mesher.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polyhedral_mesh_domain_3.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/exude_mesh_3.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/odt_optimize_mesh_3.h>
#include <CGAL/perturb_mesh_3.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <iostream>
#include <stdexcept>
#include <unordered_map>

namespace quadgraph::cgal {
namespace {

namespace parameters = CGAL::parameters;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Domain = CGAL::Polyhedral_mesh_domain_3<SurfaceMesh, Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

// Mesh_3 bounds circumradii, the field gives edge lengths: ratios of the regular triangle and tetrahedron.
constexpr double kFacetRadius = 0.57735026918962576;  // 1/sqrt(3)
constexpr double kCellRadius = 0.61237243569579452;   // sqrt(6)/4
constexpr double kFacetDistance = 0.1;                // of the local size, between a facet and the input surface
constexpr double kFacetAngle = 25;                    // degrees; refinement is proven to end below 30
constexpr double kRadiusEdgeRatio = 2.0;
constexpr double kSliverBound = 10;  // degrees of dihedral angle at which perturber and exuder are content
constexpr int kOdtIterations = 20;

// The field, up to a largest size, times a factor, as Mesh_3's MeshDomainField.
struct ScaledField {
  using FT = Kernel::FT;
  using Point_3 = Kernel::Point_3;
  using Index = Domain::Index;

  const SizingField* size;
  double factor, largest;

  FT operator()(const Point_3& p, int, const Index&) const {
    return factor * std::min((*size)({p.x(), p.y(), p.z()}), largest);
  }
};

SurfaceMesh read_surface(const std::string& path) {
  SurfaceMesh surface;
  std::ifstream file(path);
  if (!file || !CGAL::IO::read_OFF(file, surface) || surface.number_of_faces() == 0) {
    throw std::runtime_error(path + ": cannot be read as an OFF triangle surface (2-manifold, consistently oriented)");
  }
  if (!CGAL::is_triangle_mesh(surface)) throw std::runtime_error(path + ": has faces that are no triangles");
  CGAL::Polygon_mesh_processing::remove_isolated_vertices(surface);
  surface.collect_garbage();
  if (!CGAL::is_closed(surface)) throw std::runtime_error(path + ": the surface is not closed");
  if (CGAL::Polygon_mesh_processing::does_self_intersect(surface)) {
    throw std::runtime_error(path + ": the surface intersects itself");
  }
  return surface;
}

// Mean length of the edges at a vertex.
double local_size(const SurfaceMesh& surface, SurfaceMesh::Vertex_index vertex) {
  double sum = 0;
  int edges = 0;
  for (const auto halfedge : CGAL::halfedges_around_target(vertex, surface)) {
    sum += std::sqrt(CGAL::squared_distance(surface.point(vertex), surface.point(surface.source(halfedge))));
    ++edges;
  }
  return sum / edges;
}

// Samples at vertices, edge midpoints and face centroids: from vertices alone the distance to the surface would seem
// half an edge length in the middle of a face, and a large grading would coarsen the surface itself.
SizingField make_field(const SurfaceMesh& surface, double grading) {
  std::vector<Point> samples;
  std::vector<double> local;
  std::vector<double> at_vertex(surface.number_of_vertices(), 0.0);
  const auto add = [&](std::initializer_list<SurfaceMesh::Vertex_index> corners) {
    const double share = 1.0 / static_cast<double>(corners.size());
    Point place = {0, 0, 0};
    double size = 0;
    for (const auto corner : corners) {
      for (int axis = 0; axis < 3; ++axis) place[static_cast<std::size_t>(axis)] += share * surface.point(corner)[axis];
      size += share * at_vertex[corner];
    }
    samples.push_back(place);
    local.push_back(size);
  };
  for (const auto vertex : surface.vertices()) {
    at_vertex[vertex] = local_size(surface, vertex);
    add({vertex});
  }
  for (const auto edge : surface.edges()) add({surface.vertex(edge, 0), surface.vertex(edge, 1)});
  for (const auto face : surface.faces()) {
    const auto halfedge = surface.halfedge(face);
    add({surface.source(halfedge), surface.target(halfedge), surface.target(surface.next(halfedge))});
  }
  return SizingField(std::move(samples), std::move(local), grading);
}

// Smooth, then remove slivers; each step takes at most its share of the time and leaves a valid mesh.
void optimise(Complex& complex, const Domain& domain, double time_limit_s) {
  const auto began = std::chrono::steady_clock::now();
  const auto left = [&](double share) {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - began;
    return std::max(share * (time_limit_s - spent.count()), 0.1);
  };
  CGAL::odt_optimize_mesh_3(complex, domain, parameters::time_limit = left(0.5),
                            parameters::max_iteration_number = kOdtIterations);
  std::cerr << "smoothed: " << complex.number_of_cells_in_complex() << " tets" << std::endl;
  CGAL::perturb_mesh_3(complex, domain, parameters::time_limit = left(0.6), parameters::sliver_bound = kSliverBound);
  CGAL::exude_mesh_3(complex, parameters::time_limit = left(0.8), parameters::sliver_bound = kSliverBound);
}

Tets collect(const Complex& complex) {
  Tets result;
  std::unordered_map<const void*, int> index;
  const auto add = [&](const Triangulation::Vertex_handle& vertex) {
    const auto [found, fresh] = index.emplace(&*vertex, static_cast<int>(result.vertices.size()));
    if (fresh) {
      const auto& p = vertex->point();
      result.vertices.push_back({CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())});
    }
    return found->second;
  };
  for (auto facet = complex.facets_in_complex_begin(); facet != complex.facets_in_complex_end(); ++facet) {
    for (int k = 1; k < 4; ++k) add(facet->first->vertex((facet->second + k) % 4));
  }
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
    std::array<int, 4> tet{};
    for (int k = 0; k < 4; ++k) tet[static_cast<std::size_t>(k)] = add(cell->vertex(k));
    result.tets.push_back(tet);
  }
  return result;
}

}  // namespace

Tets mesh_surface(const std::string& off_path, const Options& options) {
  const SurfaceMesh surface = read_surface(off_path);
  const SizingField field = make_field(surface, options.grading);
  const double largest = options.largest;
  const Domain domain(surface);
  const Criteria criteria(Criteria::Facet_criteria(kFacetAngle, ScaledField{&field, kFacetRadius, largest},
                                                   ScaledField{&field, kFacetDistance, largest}),
                          Criteria::Cell_criteria(kRadiusEdgeRatio, ScaledField{&field, kCellRadius, largest}));
  Complex complex = CGAL::make_mesh_3<Complex>(domain, criteria, parameters::no_perturb(), parameters::no_exude(),
                                               parameters::manifold());
  if (complex.number_of_cells_in_complex() == 0) throw std::runtime_error("refinement made no tetrahedra");
  std::cerr << "refined: " << complex.number_of_cells_in_complex() << " tets" << std::endl;
  optimise(complex, domain, options.time_limit_s);
  return collect(complex);
}

}  // namespace quadgraph::cgal
