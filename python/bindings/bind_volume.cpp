// Coefficients on grids: their files, their values at places, and how they are carried from body to body.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <map>

#include "engine/base/error.h"
#include "engine/render/engine.h"
#include "engine/scene/mapped_volume.h"
#include "engine/scene/volume.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

using Triple = std::array<double, 3>;

// Of `count` cells, three numbers each.
std::vector<float> stated_of_cells(Knowledge knowledge, const FloatArray& array, std::size_t count) {
  const std::string name(knowledge_names[static_cast<std::size_t>(knowledge)]);
  if (array.ndim() != 4 || static_cast<std::size_t>(array.size()) != 3 * count) {
    throw InputError(name + ": an array of the shape of sigma_s_prime is wanted");
  }
  const auto* channels = reinterpret_cast<const glm::vec3*>(array.data());
  std::vector<float> values;
  for (std::size_t cell = 0; cell < count; ++cell) {
    const std::optional<float> value = stated_of(knowledge, glm::dvec3(channels[cell]));
    if (!value)
      throw InputError(name + ": negative or no number in cell " + std::to_string(cell) + ", 0 or more allowed");
    values.push_back(*value);
  }
  return values;
}

Volume volume_from(const FloatArray& sigma_s_prime, const FloatArray& sigma_a, const Triple& spacing,
                   const std::optional<Triple>& origin, float eta, const std::map<std::string, FloatArray>& certainty) {
  if (sigma_s_prime.ndim() != 4 || sigma_s_prime.shape(3) != 3) {
    throw InputError("sigma_s_prime: an array (nz, ny, nx, 3) is wanted");
  }
  const auto side = [&](int axis) { return static_cast<std::size_t>(sigma_s_prime.shape(axis)); };
  const std::size_t count = side(0) * side(1) * side(2);
  if (sigma_a.ndim() != 4 || static_cast<std::size_t>(sigma_a.size()) != 3 * count) {
    throw InputError("sigma_a: an array of the shape of sigma_s_prime is wanted");
  }
  Volume volume;
  volume.cells = {side(2), side(1), side(0)};
  volume.spacing = {spacing[0], spacing[1], spacing[2]};
  volume.eta = eta;
  if (origin) volume.origin = glm::dvec3((*origin)[0], (*origin)[1], (*origin)[2]);
  const auto* scattering = reinterpret_cast<const glm::vec3*>(sigma_s_prime.data());
  const auto* absorption = reinterpret_cast<const glm::vec3*>(sigma_a.data());
  for (std::size_t cell = 0; cell < count; ++cell) volume.optical.push_back({scattering[cell], absorption[cell]});
  for (std::size_t i = 0; i < knowledge_names.size(); ++i) {
    const auto found = certainty.find(std::string(knowledge_names[i]));
    if (found == certainty.end()) continue;
    volume.certainty.stated[i] = stated_of_cells(static_cast<Knowledge>(i), found->second, count);
  }
  return volume;
}

// Rows of three as (nz, ny, nx, 3).
py::array on_grid(const Volume& volume, const py::object& rows) {
  return rows.attr("reshape")(volume.cells[2], volume.cells[1], volume.cells[0], 3);
}

py::dict members_of(const Volume& volume) {
  const py::tuple coefficients = coefficient_arrays(volume.optical);
  py::dict members;
  members["sigma_s_prime"] = on_grid(volume, coefficients[0]);
  members["sigma_a"] = on_grid(volume, coefficients[1]);
  members["spacing"] = as_tuple(volume.spacing);
  members["origin"] = volume.origin ? py::object(as_tuple(*volume.origin)) : py::none();
  members["eta"] = volume.eta;
  for (std::size_t i = 0; i < knowledge_names.size(); ++i) {
    const std::vector<float>& stated = volume.certainty.stated[i];
    if (stated.empty()) continue;
    std::vector<glm::vec3> rows;
    for (float value : stated) rows.emplace_back(value);
    members[py::str(knowledge_names[i])] = on_grid(volume, own(std::move(rows)));
  }
  return members;
}

py::tuple mapped_by(const Volume& volume, const QuadGraph& body, const std::string& text) {
  const MaterialMap map = parse_map(text);
  MappedVolume made = [&] {
    const py::gil_scoped_release release;
    return mapped(volume, map, body);
  }();
  const MapReport& report = made.report;
  py::dict said;
  said["stretch"] = py::make_tuple(report.stretch.low, report.stretch.median, report.stretch.high);
  said["core"] = report.core;
  said["coarser"] = report.coarser;
  said["tets"] = report.tets;
  said["flipped_tets"] = report.flipped_tets;
  said["text"] = report_text(map, report);
  return py::make_tuple(std::move(made.volume), said);
}

py::tuple at(const Volume& volume, const FloatArray& points, const Triple& centre) {
  const auto count = static_cast<std::size_t>(points.ndim() == 2 ? points.shape(0) : 0);
  return coefficient_arrays(volume.at(vectors(points, count, "points"), glm::dvec3(centre[0], centre[1], centre[2])));
}

}  // namespace

void bind_volume(py::module_& module) {
  py::class_<Volume>(module, "Volume", "Coefficients at the middles of the cells of a grid (engine/scene/volume.h).")
      .def(py::init(&read_volume), py::arg("path"), "Raises InputError naming file, field, found, allowed.")
      .def(py::init(&volume_from), py::arg("sigma_s_prime"), py::arg("sigma_a"), py::arg("spacing"), py::arg("origin"),
           py::arg("eta"), py::arg("stated"),
           "Of (nz, ny, nx, 3) each, 1/mm; spacing and origin (3,), mm, without origin centred on the body; stated: "
           "what a .npz may say of its certainty, by name, (nz, ny, nx, 3) each. Raises InputError.")
      .def_readonly("eta", &Volume::eta)
      .def_property_readonly("cells", [](const Volume& volume) { return coefficient_arrays(volume.optical); })
      .def_property_readonly("members", &members_of, "What a .npz of it holds, by name.")
      .def("at", &at, py::arg("points"), py::arg("centre"),
           "sigma_s_prime and sigma_a, (n, 3) each, at (n, 3) mm of a body around `centre`.")
      .def("mapped", &mapped_by, py::arg("body"), py::arg("map"),
           "Carried into a QuadGraph, as --map says: the volume there, and a report. Raises InputError, FormatError.");
  module.def(
      "set_volume", [](Engine& engine, const Volume& volume) { set_material(engine, volume); }, py::arg("engine"),
      py::arg("volume"), "As Engine.set_material of a .npz (docs/scene.md). Raises InputError.");
  module.def(
      "volume_name",
      [](const std::string& material) -> std::optional<std::pair<std::string, std::optional<std::string>>> {
        const std::optional<VolumeName> name = volume_name(material);
        if (!name) return std::nullopt;
        return std::pair(name->file.string(), name->map ? std::optional(to_string(*name->map)) : std::nullopt);
      },
      py::arg("material"),
      "The file that a material's text names, and its map or None; None where it is no volume. Raises InputError.");
  module.def("with_map", &with_map, py::arg("material"), py::arg("map"),
             "A material's text with another map. Raises InputError where it names no volume.");
  module.attr("knowledge_names") = std::vector<std::string>(knowledge_names.begin(), knowledge_names.end());
}

}  // namespace quadgraph::python
