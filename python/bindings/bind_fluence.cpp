// Fluence in the body, at the unknowns of the last solve and at any point.
#include "engine/render/engine.h"
#include "engine/solve/fluence.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

py::array fluence_in(Engine& engine, const std::string& method, const FloatArray& points) {
  const auto count = static_cast<std::size_t>(points.ndim() == 2 ? points.shape(0) : 0);
  const auto places = vectors(points, count, "points");
  std::vector<glm::vec3> found = [&] {
    const py::gil_scoped_release release;
    return fluence_at(engine.simulation(), from_name<Method>(method), places, heed_signals);
  }();
  return own(std::move(found));
}

py::tuple solved_tets(Engine& engine) {
  const Level& level = engine.simulation().present_level();
  const py::tuple found = coefficient_arrays(tet_coefficients(engine.device(), engine.simulation()));
  return py::make_tuple(own(std::vector<glm::vec3>(level.vertices.begin(), level.vertices.end())), found[0], found[1]);
}

}  // namespace

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
  module.def("fluence_at", &fluence_in, py::arg("engine"), py::arg("method"), py::arg("points"),
             "The same at points (n, 3), mm; (n, 3), NaN outside the body. Raises InputError.");
  module.def("solved_tets", &solved_tets, py::arg("engine"),
             "Vertices of level 0 as they lie now, (n_v, 3) mm, and the coefficients in its tets that the last solve "
             "was for, (n_t, 3) 1/mm each: sigma_s_prime and sigma_a.");
  module.def(
      "walked_exitance",
      [](Engine& engine) {
        WalkedExitance found = engine.simulation().walked_exitance();
        return py::make_tuple(own(std::move(found.mean)), own(std::move(found.standard_error)));
      },
      py::arg("engine"),
      "What the walks of `certify` found, per outside face of level 0, (n, 3) W/mm^2: mean and standard error. Raises "
      "InputError.");
}

}  // namespace quadgraph::python
