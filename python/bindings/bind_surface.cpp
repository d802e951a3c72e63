// Where places lie about a surface: which of its triangles is the nearest, and how deep they are in a body.
#include "engine/base/all_cores.h"
#include "engine/base/error.h"
#include "engine/optics/nearest_face.h"
#include "engine/scene/body_surface.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

std::size_t rows_of(const py::array& array) {
  return static_cast<std::size_t>(array.ndim() == 2 ? array.shape(0) : 0);
}

py::tuple nearest_faces(const FloatArray& vertices, const IndexArray& triangles, const FloatArray& points) {
  const std::span<const glm::vec3> places = vectors(points, rows_of(points), "points");
  Level surface;
  surface.vertices = vectors(vertices, rows_of(vertices), "vertices");
  const std::size_t count = rows_of(triangles);
  if (count == 0 || triangles.shape(1) != 3) throw InputError("triangles: an array (m, 3) of at least one is wanted");
  surface.faces = {reinterpret_cast<const glm::uvec3*>(triangles.data()), count};
  for (py::ssize_t i = 0; i < triangles.size(); ++i) {
    if (triangles.data()[i] >= surface.vertices.size()) {
      throw InputError("triangles: vertex " + std::to_string(triangles.data()[i]) + " found, there are " +
                       std::to_string(surface.vertices.size()));
    }
  }
  std::vector<std::uint32_t> faces(places.size());
  std::vector<float> distances(places.size());
  {
    const py::gil_scoped_release release;
    const NearestFace nearest(surface);
    on_all_cores(places.size(), [&](std::size_t i) {
      const NearestFace::Found found = nearest.find(places[i]);
      faces[i] = found.face;
      distances[i] = found.distance;
    });
  }
  return py::make_tuple(own(std::move(faces)), own(std::move(distances)));
}

py::array depths(const QuadGraph& body, const FloatArray& points) {
  const std::span<const glm::vec3> places = vectors(points, rows_of(points), "points");
  std::vector<float> found(places.size());
  {
    const py::gil_scoped_release release;
    const BodySurface surface(body);
    on_all_cores(places.size(),
                 [&](std::size_t i) { found[i] = static_cast<float>(surface.find(glm::dvec3(places[i])).depth); });
  }
  return own(std::move(found));
}

}  // namespace

void bind_surface(py::module_& module) {
  module.def("nearest_faces", &nearest_faces, py::arg("vertices"), py::arg("triangles"), py::arg("points"),
             "Of triangles (m, 3) of vertices (k, 3), mm, the nearest to each of (n, 3) points, and how far it is, mm: "
             "(n,) each. Raises InputError.");
  module.def("depths", &depths, py::arg("body"), py::arg("points"),
             "How deep (n, 3) points lie below the surface of a QuadGraph, mm, (n,); negative outside. Raises "
             "InputError.");
}

}  // namespace quadgraph::python
