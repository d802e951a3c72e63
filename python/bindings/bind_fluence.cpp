// Fluence in the body, at the unknowns of the last solve and at any point.
#include "engine/render/engine.h"
#include "engine/solve/fluence.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {

void bind_fluence(py::module_& module) {
  module.def(
      "fluence",
      [](Engine& engine, const std::string& method) {
        Fluence found = fluence(engine.simulation(), from_name<Method>(method));
        return py::make_tuple(own(std::move(found.points)), own(std::move(found.values)));
      },
      py::arg("engine"), py::arg("method"),
      "points (n, 3) mm and values (n, 3) W/mm^2 of the last solve, which was by `method` (engine/solve/fluence.h). "
      "Raises InputError.");
  module.def(
      "fluence_at",
      [](Engine& engine, const std::string& method, const FloatArray& points) {
        const auto count = static_cast<std::size_t>(points.ndim() == 2 ? points.shape(0) : 0);
        return own(fluence_at(engine.simulation(), from_name<Method>(method), vectors(points, count, "points")));
      },
      py::arg("engine"), py::arg("method"), py::arg("points"),
      "The same at points (n, 3), mm; (n, 3), NaN outside the body. Raises InputError.");
}

}  // namespace quadgraph::python
