// The operators and the CPU reference solver, double precision.
#include <pybind11/stl.h>

#include "engine/base/error.h"
#include "engine/optics/surface_boundary.h"
#include "engine/reference/radiance.h"
#include "engine/reference/reference.h"
#include "engine/reference/source_walk.h"
#include "engine/reference/stored_entries.h"
#include "engine/reference/tet_points.h"
#include "engine/solve/beams.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

// (n, 3) of phi alone with diffusion, (n, 2, 3) of phi and phi2 with sp3.
py::array fields(const std::vector<Field>& values, Model model) {
  const auto n = static_cast<py::ssize_t>(values.size());
  const py::ssize_t moments = model == Model::sp3 ? 2 : 1;
  py::array_t<double> array({n, moments, py::ssize_t{3}});
  double* to = array.mutable_data();
  for (const Field& field : values) {
    for (py::ssize_t m = 0; m < moments; ++m) {
      for (int c = 0; c < 3; ++c) *to++ = (m == 0 ? field.phi : field.phi2)[c];
    }
  }
  return model == Model::sp3 ? py::array(array) : py::array(array.reshape({n, py::ssize_t{3}}));
}

// (n, 3) of a11 with diffusion, (n, 3, 3) of a11, a12, a22 with sp3.
py::array blocks(const std::vector<Block>& values, Model model) {
  const auto n = static_cast<py::ssize_t>(values.size());
  const py::ssize_t entries = model == Model::sp3 ? 3 : 1;
  py::array_t<double> array({n, entries, py::ssize_t{3}});
  double* to = array.mutable_data();
  for (const Block& block : values) {
    for (py::ssize_t m = 0; m < entries; ++m) {
      for (int c = 0; c < 3; ++c) *to++ = (m == 0 ? block.a11 : m == 1 ? block.a12 : block.a22)[c];
    }
  }
  return model == Model::sp3 ? py::array(array) : py::array(array.reshape({n, py::ssize_t{3}}));
}

py::dict rows_dict(Rows&& rows, Model model) {
  py::dict d;
  d["weight"] = blocks(rows.weight, model);
  d["diagonal"] = blocks(rows.diagonal, model);
  d["offset"] = own(std::move(rows.offset));
  d["column"] = own(std::move(rows.column));
  d["to_phi"] = own(std::move(rows.to_phi));
  return d;
}

Problem problem_of(const std::string& method, const std::string& source, const std::string& model,
                   std::span<const gpu::Optical> optical, double eta) {
  return {from_name<Method>(method), from_name<Source>(source), from_name<Model>(model), optical, eta};
}

py::dict assemble_dict(const QuadGraph& graph, std::uint32_t index, const std::string& method,
                       const FloatArray& sigma_s_prime, const FloatArray& sigma_a, double eta, const std::string& model,
                       const std::string& source) {
  const Level& level = level_of(graph, index);
  const auto optical = optical_from(sigma_s_prime, sigma_a, level.node_count());
  const Problem problem = problem_of(method, source, model, optical, eta);
  return rows_dict(assemble(level, problem), problem.model);
}

py::array buried_load_array(const QuadGraph& graph, std::uint32_t index, const std::string& method,
                            const FloatArray& sigma_s_prime, const FloatArray& sigma_a, double eta, const FloatArray& q,
                            const std::string& model, const std::optional<std::array<float, 3>>& direction) {
  const Level& level = level_of(graph, index);
  const auto optical = optical_from(sigma_s_prime, sigma_a, level.node_count());
  check_optical(optical, level.node_count());
  check_eta(eta);
  const Problem problem = problem_of(method, "buried", model, optical, eta);
  std::vector<Quarters> quarters;
  for (const glm::vec3& value : vectors(q, level.face_count(), "q")) quarters.push_back({value, value, value, value});
  const std::vector<glm::dvec3> scattered =
      walk_source(level, problem, beam_along(as_vector(direction)).way, quarters).scattered;
  return fields(buried_load(level, problem, scattered), problem.model);
}

py::dict solution_dict(ReferenceSolution&& solution) {
  py::dict d;
  d["phi"] = own(std::move(solution.phi));
  d["phi2"] = own(std::move(solution.phi2));
  d["phi_face"] = own(std::move(solution.phi_face));
  d["exitance"] = own(std::move(solution.exitance));
  d["unscattered"] = own(std::move(solution.unscattered));
  d["energy"] = as_dict(solution.energy);
  d["clipped"] = as_tuple(solution.clipped);
  d["report"] = as_dict(solution.report);
  return d;
}

py::dict reference_solution(const QuadGraph& graph, std::uint32_t index, const FloatArray& sigma_s_prime,
                            const FloatArray& sigma_a, double eta, const FloatArray& q,
                            const std::optional<std::array<float, 3>>& direction, const std::string& method,
                            const std::string& solver, const std::string& source, const std::string& model,
                            double tolerance, std::uint32_t max_iterations, bool stored) {
  const Level& level = level_of(graph, index);
  const SolveOptions options = options_from(method, solver, source, model, tolerance, max_iterations);
  const auto optical = optical_from(sigma_s_prime, sigma_a, level.node_count());
  const EnteringLight light{beam_along(as_vector(direction)).way, vectors(q, level.face_count(), "q")};
  ReferenceSolution solution = [&] {
    const py::gil_scoped_release release;
    return solve_reference(level, optical, eta, light, options, stored ? Entries::stored : Entries::exact);
  }();
  return solution_dict(std::move(solution));
}

py::dict radiance_dict(const QuadGraph& graph, std::uint32_t index, const FloatArray& sigma_s_prime,
                       const FloatArray& sigma_a, double eta, const FloatArray& q,
                       const std::optional<std::array<float, 3>>& direction, const DoubleArray& phi,
                       const std::vector<std::uint32_t>& faces, const DoubleArray& outside) {
  const Level& level = level_of(graph, index);
  const auto optical = optical_from(sigma_s_prime, sigma_a, level.node_count());
  check_optical(optical, level.node_count());
  check_eta(eta);
  const std::vector<glm::dvec3> fluence = vectors(phi, level.vertex_count(), "phi");
  const std::vector<glm::dvec3> ways = vectors(outside, faces.size(), "outside");
  for (const std::uint32_t f : faces) {
    if (f >= level.face_count()) throw InputError("faces: " + std::to_string(f) + " is not a face of the level");
  }
  std::vector<Quarters> quarters;
  for (const glm::vec3& value : vectors(q, level.face_count(), "q")) quarters.push_back({value, value, value, value});
  const BeamLight beam{beam_along(as_vector(direction)).way, quarters};
  const Problem problem{Method::fem, Source::buried, Model::sp3, optical, eta};
  Uncollided fields = uncollided(level, problem, std::span(&beam, 1), vertex_starts(level));
  const InsideLight light{fluence, fields};
  std::vector<glm::dvec3> radiance;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    radiance.push_back(gathered_radiance(level, problem, light, faces[i], glm::dvec3(1.0 / 3), ways[i]));
  }
  py::dict d;
  d["radiance"] = own(std::move(radiance));
  d["exitance"] = own(gathered_exitance(level, problem, light));
  d["entry"] = own(std::move(fields.entry));
  d["depth"] = own(std::move(fields.depth));
  return d;
}

py::dict boundary_dict(const std::string& method, const std::string& source, const std::string& model, double eta) {
  const Boundary boundary =
      boundary_of(from_name<Method>(method), from_name<Source>(source), from_name<Model>(model), eta);
  py::dict d;
  d["k11"] = boundary.k11;
  d["k12"] = boundary.k12;
  d["k22"] = boundary.k22;
  d["source"] = boundary.source;
  d["reflected"] = boundary.reflected;
  return d;
}

py::tuple coefficients_at_nodes(const QuadGraph& graph, std::uint32_t level, const gpu::Material& material) {
  return coefficient_arrays(evaluate_material(level_of(graph, level), material));
}

}  // namespace

namespace {

// What surfaces do to light, as solves know it.
void bind_boundaries(py::module_& module) {
  module.def("boundary", &boundary_dict, py::arg("method"), py::arg("source"), py::arg("model"), py::arg("eta"),
             "k11, k12, k22, source, reflected (engine/optics/boundary.h).");
  module.def(
      "fresnel_moment", [](int n, double eta, float roughness) { return fresnel_moment(n, {eta, {}, roughness}); },
      py::arg("n"), py::arg("eta"), py::arg("roughness") = 0.0f,
      "R_n: integral of the internal reflectance times mu^n over the inside cosine, of a surface of GGX alpha "
      "`roughness`.");
  module.def(
      "rough_boundary",
      [](double eta, float roughness) {
        const RoughBoundary found = rough_boundary({eta, {}, roughness});
        return std::vector<float>(found.begin(), found.end());
      },
      py::arg("eta"), py::arg("roughness"),
      "What a surface of GGX alpha `roughness` mirrors, at the squares of 32 even steps of the outside cosine; the "
      "mean "
      "inside cosine of what enters, at the same; what it mirrors at 128 even steps of the inside cosine "
      "(engine/optics/surface_boundary.h).");
}

}  // namespace

void bind_reference(py::module_& module) {
  const SolveOptions usual = reference_options();
  module.def(
      "points_in_tets",
      [](const QuadGraph& graph, std::uint32_t level) { return own(points_in_tets(level_of(graph, level))); },
      py::arg("graph"), py::arg("level"),
      "(4 n_t, 3) mm, points in each tet, one of all after the other (engine/reference/tet_points.h).");
  module.def("evaluate_material", &coefficients_at_nodes, py::arg("graph"), py::arg("level"), py::arg("material"),
             "sigma_s_prime and sigma_a, (n, 3) in 1/mm, at the nodes.");
  module.def("assemble", &assemble_dict, py::arg("graph"), py::arg("level"), py::arg("method"),
             py::arg("sigma_s_prime"), py::arg("sigma_a"), py::arg("eta"), py::arg("model"),
             py::arg("source") = name_of(usual.source),
             "Rows of the symmetric system A x = b, (phi, phi2) = to_phi * x (engine/reference/operator.h): offset, "
             "column, to_phi (n, 3), and weight and diagonal, (m, 3) with diffusion, (m, 3, 3) of a11, a12, a22 with "
             "sp3.");
  module.def(
      "buried_load", &buried_load_array, py::arg("graph"), py::arg("level"), py::arg("method"),
      py::arg("sigma_s_prime"), py::arg("sigma_a"), py::arg("eta"), py::arg("q"), py::arg("model"),
      py::arg("direction") = py::none(),
      "b of the buried source for irradiance q (n_f, 3) in W/mm^2 that travels along direction (3,) outside, None: "
      "Lambertian: (n, 3), or (n, 2, 3) with sp3.");
  module.def("solve_reference", &reference_solution, py::arg("graph"), py::arg("level"), py::arg("sigma_s_prime"),
             py::arg("sigma_a"), py::arg("eta"), py::arg("q"), py::arg("direction") = py::none(),
             py::arg("method") = name_of(usual.method), py::arg("solver") = name_of(usual.solver),
             py::arg("source") = name_of(usual.source), py::arg("model") = name_of(usual.model),
             py::arg("tolerance") = usual.tolerance, py::arg("max_iterations") = usual.max_iterations,
             py::arg("stored") = false,
             "Solve one level on the CPU; stored: with the entries of the operator rounded as a device stores them. "
             "sigma_s_prime and sigma_a (n, 3) 1/mm at the nodes; q (n_f, 3) W/mm^2, the "
             "irradiance that the surface lets in; direction (3,) in which it travels outside, None: Lambertian. "
             "Returns phi and phi2 per carrier, phi_face, exitance and unscattered per outside face (W/mm^2), energy "
             "(W), clipped, report. Raises InputError, SolverError.");
  module.def("radiance_reference", &radiance_dict, py::arg("graph"), py::arg("level"), py::arg("sigma_s_prime"),
             py::arg("sigma_a"), py::arg("eta"), py::arg("q"), py::arg("direction"), py::arg("phi"), py::arg("faces"),
             py::arg("outside"),
             "Gathered radiance on the CPU (engine/reference/radiance.h), unscaled. sigma_s_prime, sigma_a, eta, q and "
             "direction as for solve_reference; phi (n_v, 3) of its solution with fem; faces (n,) and outside (n, 3), "
             "the unit directions into which light leaves their centroids. Returns radiance (n, 3) in W/(mm^2 sr), "
             "exitance (n_f, 3), entry (n_v, 3) in W/mm^2 and depth (n_v, 3). Raises InputError.");
  module.def(
      "entry_format",
      [](const QuadGraph& graph, std::uint32_t level, const std::string& method) {
        const EntryFormat format = format_of(level_of(graph, level), from_name<Method>(method));
        return format == EntryFormat::packed ? "packed" : "plain";
      },
      py::arg("graph"), py::arg("level"), py::arg("method"),
      "How a device stores the entries of the operator: 'packed', with a shared exponent, or 'plain', in single "
      "precision.");
  bind_boundaries(module);
}

}  // namespace quadgraph::python
