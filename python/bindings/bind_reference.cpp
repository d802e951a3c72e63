// The operators and the CPU reference solver, double precision.
#include <pybind11/stl.h>

#include "engine/graph/reference.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

const Level& level_of(const QuadGraph& graph, std::uint32_t index) {
  if (index >= graph.levels().size()) {
    throw py::index_error("level " + std::to_string(index) + ": the file has " + std::to_string(graph.levels().size()));
  }
  return graph.levels()[index];
}

py::dict rows_dict(Rows&& rows) {
  py::dict d;
  d["offset"] = own(std::move(rows.offset));
  d["column"] = own(std::move(rows.column));
  d["weight"] = own(std::move(rows.weight));
  d["diagonal"] = own(std::move(rows.diagonal));
  d["to_phi"] = own(std::move(rows.to_phi));
  return d;
}

}  // namespace

void bind_reference(py::module_& module) {
  module.def(
      "evaluate_material",
      [](const QuadGraph& graph, std::uint32_t level, const gpu::Material& material) {
        const auto optical = evaluate_material(level_of(graph, level), material);
        std::vector<glm::vec3> sigma_s_prime, sigma_a;
        for (const gpu::Optical& o : optical) {
          sigma_s_prime.push_back(o.sigma_s_prime);
          sigma_a.push_back(o.sigma_a);
        }
        return py::make_tuple(own(std::move(sigma_s_prime)), own(std::move(sigma_a)));
      },
      py::arg("graph"), py::arg("level"), py::arg("material"),
      "sigma_s_prime and sigma_a, (n, 3) in 1/mm, at the nodes.");
  module.def(
      "assemble",
      [](const QuadGraph& graph, std::uint32_t index, const std::string& method, const FloatArray& sigma_s_prime,
         const FloatArray& sigma_a, double eta) {
        const Level& level = level_of(graph, index);
        return rows_dict(
            assemble(level, method_from_name(method), optical_from(sigma_s_prime, sigma_a, level.node_count()), eta));
      },
      py::arg("graph"), py::arg("level"), py::arg("method"), py::arg("sigma_s_prime"), py::arg("sigma_a"),
      py::arg("eta"), "Rows of the symmetric system A x = b, phi = to_phi * x (engine/graph/operator.h).");
  module.def(
      "right_hand_side",
      [](const QuadGraph& graph, std::uint32_t index, const std::string& method, const FloatArray& sigma_s_prime,
         const FloatArray& sigma_a, double eta, const FloatArray& q) {
        const Level& level = level_of(graph, index);
        return own(right_hand_side(level, method_from_name(method),
                                   optical_from(sigma_s_prime, sigma_a, level.node_count()), eta,
                                   vectors(q, level.face_count(), "q")));
      },
      py::arg("graph"), py::arg("level"), py::arg("method"), py::arg("sigma_s_prime"), py::arg("sigma_a"),
      py::arg("eta"), py::arg("q"), "b for irradiance q (n_f, 3) in W/mm^2.");
  module.def(
      "solve_reference",
      [](const QuadGraph& graph, std::uint32_t index, const FloatArray& sigma_s_prime, const FloatArray& sigma_a,
         double eta, const FloatArray& q, const std::string& method, const std::string& solver, double tolerance,
         std::uint32_t max_iterations) {
        const Level& level = level_of(graph, index);
        const SolveOptions options{.method = method_from_name(method),
                                   .solver = solver_from_name(solver),
                                   .tolerance = tolerance,
                                   .max_iterations = max_iterations};
        const auto optical = optical_from(sigma_s_prime, sigma_a, level.node_count());
        const auto irradiance = vectors(q, level.face_count(), "q");
        ReferenceSolution solution = [&] {
          const py::gil_scoped_release release;
          return solve_reference(level, optical, eta, irradiance, options);
        }();
        py::dict d;
        d["phi"] = own(std::move(solution.phi));
        d["phi_face"] = own(std::move(solution.phi_face));
        d["exitance"] = own(std::move(solution.exitance));
        d["energy"] = as_dict(solution.energy);
        d["report"] = as_dict(solution.report);
        return d;
      },
      py::arg("graph"), py::arg("level"), py::arg("sigma_s_prime"), py::arg("sigma_a"), py::arg("eta"), py::arg("q"),
      py::arg("method") = "fem", py::arg("solver") = "dpcg", py::arg("tolerance") = 1e-10,
      py::arg("max_iterations") = 100000,
      "Solve one level on the CPU. sigma_s_prime and sigma_a (n, 3) 1/mm at the nodes, q (n_f, 3) W/mm^2. Returns "
      "phi per unknown, phi_face and exitance per outside face (W/mm^2), energy (W), report.");
}

}  // namespace quadgraph::python
