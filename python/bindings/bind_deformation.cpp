// Deformations: dicts, JSON text, and shapes in memory.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "engine/base/error.h"
#include "engine/base/json_text.h"
#include "engine/deform/deform.h"
#include "engine/scene/deformer_json.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

std::vector<Deformer> parsed(const std::string& text) {
  const Json json = parse_json(text);
  std::vector<Deformer> list;
  for (const JsonField& field : JsonField(json, "").items()) list.push_back(deformer_from(field));
  return list;
}

std::string as_json(const py::object& value) {
  return py::module_::import("json").attr("dumps")(value).cast<std::string>();
}

// (shapes, vertices, 3) in mm.
ShapesOfMesh shapes_of(const FloatArray& array, const std::string& what) {
  if (array.ndim() != 3 || array.shape(2) != 3) throw InputError(what + ": expected (shapes, vertices, 3)");
  const auto count = static_cast<std::size_t>(array.shape(0)), size = static_cast<std::size_t>(array.shape(1));
  const auto* first = reinterpret_cast<const glm::vec3*>(array.data());
  ShapesOfMesh shapes;
  for (std::size_t s = 0; s < count; ++s) shapes.emplace_back(first + s * size, first + (s + 1) * size);
  return shapes;
}

std::shared_ptr<Shapes> make_shapes(const FloatArray& display, const std::vector<FloatArray>& levels) {
  auto shapes = std::make_shared<Shapes>();
  shapes->display = shapes_of(display, "display");
  for (const FloatArray& level : levels) shapes->levels.push_back(shapes_of(level, "levels"));
  return shapes;
}

// One with shapes that JSON cannot hold.
Deformer displaced(const py::dict& fields) {
  Deformer deformer{.kind = DeformerKind::displaced};
  deformer.shapes = fields["shapes"].cast<std::shared_ptr<Shapes>>();
  deformer.weights = fields.contains("weights")
                         ? fields["weights"].cast<std::vector<double>>()
                         : frame_weights(fields["frame"].cast<double>(), deformer.shapes->count());
  return deformer;
}

}  // namespace

std::vector<Deformer> deformation_from(const py::object& list) {
  if (py::isinstance<py::str>(list)) return parsed(list.cast<std::string>());
  // What JSON holds goes through it in one piece, so that complaints count as the caller does.
  std::vector<std::pair<std::size_t, Deformer>> others;
  py::list plain;
  std::size_t place = 0;
  for (const py::handle item : list) {
    const auto object = py::reinterpret_borrow<py::object>(item);
    const bool in_memory = py::isinstance<py::dict>(object) && object.contains("shapes") &&
                           py::isinstance<Shapes>(object[py::str("shapes")]);
    if (in_memory) others.emplace_back(place, displaced(object));
    plain.append(in_memory ? py::dict(py::arg("type") = "twist", py::arg("degrees") = 0) : object);
    ++place;
  }
  std::vector<Deformer> deformers = parsed(as_json(plain));
  for (auto& [at, deformer] : others) deformers[at] = std::move(deformer);
  return deformers;
}

void bind_deformation(py::module_& module) {
  py::class_<Shapes, std::shared_ptr<Shapes>>(module, "Shapes", "Displacements of all vertices of a body, in mm.")
      .def(py::init(&make_shapes), py::arg("display"), py::arg("levels"),
           "display (shapes, n_d, 3), levels: (shapes, n_v, 3) for each level, finest first. Raises InputError.")
      .def_property_readonly("count", &Shapes::count);
  module.def(
      "check_deformation",
      [](const py::object& list) {
        Json json = Json::array();
        for (const Deformer& deformer : deformation_from(list)) json.push_back(to_json(deformer));
        return json.dump();
      },
      py::arg("list"), "The list as JSON text, all fields written out. Raises InputError.");
  module.def(
      "mean_value_weights",
      [](const FloatArray& vertices, const IndexArray& triangles, const FloatArray& points) {
        Deformer cage{.kind = DeformerKind::cage};
        for (const glm::vec3& v : vectors(vertices, static_cast<std::size_t>(vertices.shape(0)), "vertices")) {
          cage.cage.emplace_back(v);
        }
        cage.moved = cage.cage;
        const auto ids = triangles.unchecked<2>();
        for (py::ssize_t t = 0; t < ids.shape(0); ++t) cage.triangles.emplace_back(ids(t, 0), ids(t, 1), ids(t, 2));
        check_deformer(cage);
        const auto all = vectors(points, static_cast<std::size_t>(points.shape(0)), "points");
        const std::vector<float> weights = cage_weights(cage, all);
        py::array_t<float> array({static_cast<py::ssize_t>(cage.cage.size()), static_cast<py::ssize_t>(all.size())});
        std::copy(weights.begin(), weights.end(), array.mutable_data());
        return array;
      },
      py::arg("vertices"), py::arg("triangles"), py::arg("points"),
      "Mean value coordinates of points (n, 3) in a closed mesh: (vertices, n). Raises InputError.");
}

}  // namespace quadgraph::python
