// The shortest-path method's parts: shortest paths through given cells, on the device and on the CPU, and voxels.
#include <pybind11/stl.h>

#include "engine/base/error.h"
#include "engine/devices/open_device.h"
#include "engine/path/given_cells.h"
#include "engine/reference/path_reference.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

// Sides along x, y, z of arrays (3, nz, ny, nx).
glm::uvec3 cells_of(const FloatArray& array, const std::string& what) {
  if (array.ndim() != 4 || array.shape(0) != 3) throw InputError(what + ": an array (3, nz, ny, nx) is wanted");
  return {static_cast<std::uint32_t>(array.shape(3)), static_cast<std::uint32_t>(array.shape(2)),
          static_cast<std::uint32_t>(array.shape(1))};
}

std::span<const float> values(const FloatArray& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

template <typename Scalar>
py::array_t<Scalar> in_cells(const std::vector<Scalar>& values, const glm::uvec3& size, py::ssize_t channels) {
  std::vector<py::ssize_t> shape = {py::ssize_t{size.z}, py::ssize_t{size.y}, py::ssize_t{size.x}};
  if (channels > 1) shape.insert(shape.begin(), channels);
  py::array_t<Scalar> array(shape);
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

void check_messages(const device::Device& device) {
  const auto& messages = device.validation_messages();
  if (!messages.empty()) throw DeviceError("validation: " + messages.front());
}

py::array paths(const FloatArray& cost, const FloatArray& entering, float cell, const std::string& solver,
                const std::string& device, bool validation) {
  const glm::uvec3 size = cells_of(cost, "cost");
  const PathSolver kind = from_name<PathSolver>(solver);
  const std::shared_ptr<device::Device> opened = open_device({validation, device, nullptr});
  const std::vector<float> found = paths_through(*opened, size, cell, values(cost), values(entering), kind);
  check_messages(*opened);
  return in_cells(found, size, 3);
}

py::array reference_paths(const FloatArray& cost, const FloatArray& start, float cell, const std::string& solver) {
  const glm::uvec3 size = cells_of(cost, "cost");
  if (start.size() != cost.size()) throw InputError("start: as many values as cost has are wanted");
  const std::size_t count = static_cast<std::size_t>(cost.size()) / 3;
  std::vector<double> all;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto found = shortest_paths({.size = size,
                                       .cell = static_cast<double>(cell),
                                       .cost = values(cost).subspan(c * count, count),
                                       .start = values(start).subspan(c * count, count)},
                                      from_name<PathSolver>(solver));
    all.insert(all.end(), found.begin(), found.end());
  }
  return in_cells(all, size, 3);
}

py::dict voxels(const FloatArray& vertices, const IndexArray& triangles, std::uint32_t cells, const std::string& device,
                bool validation) {
  check_options(PathOptions{.cells = cells});
  if (triangles.ndim() != 2 || triangles.shape(1) != 3) throw InputError("triangles: an array (n, 3) is wanted");
  const auto count = static_cast<std::size_t>(vertices.ndim() == 2 ? vertices.shape(0) : 0);
  const std::span<const glm::vec3> places = vectors(vertices, count, "vertices");
  const std::span<const glm::uvec3> corners{reinterpret_cast<const glm::uvec3*>(triangles.data()),
                                            static_cast<std::size_t>(triangles.shape(0))};
  for (const glm::uvec3& corner : corners) {
    for (int k = 0; k < 3; ++k) {
      if (corner[k] >= count) throw InputError("triangles: vertex " + std::to_string(corner[k]) + " is not there");
    }
  }
  const std::shared_ptr<device::Device> opened = open_device({validation, device, nullptr});
  const GivenVoxels found = voxels_of(*opened, places, corners, cells);
  check_messages(*opened);
  py::dict d;
  d["flags"] = in_cells(found.flags, found.grid.size, 1);
  d["origin"] = as_tuple(glm::dvec3(found.grid.origin));
  d["cell"] = found.grid.cell;
  return d;
}

}  // namespace

void bind_path(py::module_& module) {
  const std::string solver(name_of(PathOptions{}.solver));
  module.attr("PATH_FAR") = gpu::PATH_FAR;
  module.attr("CELL_SOLID") = gpu::CELL_SOLID;
  module.attr("CELL_INSIDE") = gpu::CELL_INSIDE;
  module.attr("CELL_SURFACE") = gpu::CELL_SURFACE;
  module.def("shortest_paths", &paths, py::arg("cost"), py::arg("entering"), py::arg("cell"),
             py::arg("solver") = solver, py::arg("device") = "", py::arg("validation") = false,
             "Lengths (3, nz, ny, nx) float32 of the shortest optical paths on the device; PATH_FAR: none. cost, as "
             "large: 1/mm, below 0 where a cell is not solid (in all channels alike); entering: W/mm^2, of which the "
             "negative logarithm is the length at the start, 0: none; cell: mm; solver: eikonal or lattice. Sides are "
             "multiples of 8. Raises InputError, DeviceError.");
  module.def("shortest_paths_reference", &reference_paths, py::arg("cost"), py::arg("start"), py::arg("cell"),
             py::arg("solver") = solver,
             "The same in double precision on the CPU, from lengths at the start, PATH_FAR: none.");
  module.def("voxels", &voxels, py::arg("vertices"), py::arg("triangles"), py::arg("cells"), py::arg("device") = "",
             py::arg("validation") = false,
             "A mesh, (n, 3) mm and (m, 3), as solid cells on the device: flags (nz, ny, nx) of CELL_SOLID, "
             "CELL_INSIDE and CELL_SURFACE; origin, the low corner, and cell, mm. cells: along the longest side.");
}

}  // namespace quadgraph::python
