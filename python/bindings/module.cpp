// quadgraph._core: the module, its errors, and the gate between NumPy arrays and spans.
#include <pybind11/stl.h>

#include "engine/base/error.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {

namespace {

void check_shape(const py::array& array, std::size_t count, const std::string& what) {
  if (array.ndim() == 2 && array.shape(1) == 3 && static_cast<std::size_t>(array.shape(0)) == count) return;
  std::string shape;
  for (py::ssize_t d = 0; d < array.ndim(); ++d) shape += (d > 0 ? ", " : "") + std::to_string(array.shape(d));
  throw InputError(what + ": shape (" + shape + "), expected (" + std::to_string(count) + ", 3)");
}

}  // namespace

std::span<const glm::vec3> vectors(const FloatArray& array, std::size_t count, const std::string& what) {
  check_shape(array, count, what);
  return {reinterpret_cast<const glm::vec3*>(array.data()), count};
}

std::vector<glm::dvec3> vectors(const DoubleArray& array, std::size_t count, const std::string& what) {
  check_shape(array, count, what);
  const auto* data = reinterpret_cast<const glm::dvec3*>(array.data());
  return {data, data + count};
}

std::vector<gpu::Optical> optical_from(const FloatArray& sigma_s_prime, const FloatArray& sigma_a, std::size_t count) {
  const auto scattering = vectors(sigma_s_prime, count, "sigma_s_prime");
  const auto absorption = vectors(sigma_a, count, "sigma_a");
  std::vector<gpu::Optical> optical(count);
  for (std::size_t i = 0; i < count; ++i) optical[i] = {scattering[i], absorption[i]};
  return optical;
}

py::tuple coefficient_arrays(std::span<const gpu::Optical> optical) {
  std::vector<glm::vec3> scattering, absorption;
  for (const gpu::Optical& at : optical) {
    scattering.push_back(at.sigma_s_prime);
    absorption.push_back(at.sigma_a);
  }
  return py::make_tuple(own(std::move(scattering)), own(std::move(absorption)));
}

const Level& level_of(const QuadGraph& graph, std::uint32_t index) {
  if (index >= graph.levels().size()) {
    throw py::index_error("level " + std::to_string(index) + ": the file has " + std::to_string(graph.levels().size()));
  }
  return graph.levels()[index];
}

SolveOptions options_from(const std::string& method, const std::string& solver, const std::string& source,
                          const std::string& model, double tolerance, std::uint32_t max_iterations) {
  return {.method = from_name<Method>(method),
          .solver = from_name<SolverKind>(solver),
          .source = from_name<Source>(source),
          .model = from_name<Model>(model),
          .tolerance = tolerance,
          .max_iterations = max_iterations};
}

std::optional<glm::vec3> as_vector(const std::optional<std::array<float, 3>>& components) {
  if (!components) return std::nullopt;
  return glm::vec3((*components)[0], (*components)[1], (*components)[2]);
}

py::tuple as_tuple(const glm::dvec3& v) {
  return py::make_tuple(v.x, v.y, v.z);
}

py::dict as_dict(const Energy& energy) {
  py::dict d;
  d["entered"] = as_tuple(energy.entered);
  d["re_entered"] = as_tuple(energy.re_entered);
  d["scattered_out"] = as_tuple(energy.scattered_out);
  d["absorbed"] = as_tuple(energy.absorbed);
  d["unscattered_out"] = as_tuple(energy.unscattered_out);
  d["balance"] = as_tuple(energy.balance());
  return d;
}

py::dict as_dict(const LevelReport& report) {
  py::dict d;
  d["level"] = report.level;
  d["unknowns"] = report.unknowns;
  d["iterations"] = report.iterations;
  d["residual"] = report.residual;
  d["converged"] = report.converged;
  return d;
}

py::object error_dict(const std::optional<ErrorEstimate>& estimate) {
  if (!estimate) return py::none();
  py::dict d;
  d["whole"] = estimate->whole;
  d["unlit"] = estimate->unlit;
  d["dimmest"] = estimate->dimmest;
  return d;
}

namespace {

py::dict correction_dict(const CorrectionReport& correction) {
  py::list sweeps;
  for (const CorrectedSweep& sweep : correction.sweeps) {
    py::dict d;
    d["change"] = error_dict(sweep.change);
    d["noise"] = error_dict(sweep.noise);
    d["points"] = sweep.points;
    sweeps.append(d);
  }
  py::dict d;
  d["sweeps"] = sweeps;
  d["segments"] = correction.segments;
  return d;
}

py::dict part_dict(const CertifiedPart& part) {
  py::dict d;
  d["power"] = part.power;
  d["power_noise"] = part.power_noise;
  d["error"] = part.error;
  d["error_noise"] = part.error_noise;
  return d;
}

py::dict certificate_dict(const Certificate& found) {
  py::dict d;
  d["whole"] = part_dict(found.whole);
  d["unlit"] = part_dict(found.unlit);
  d["dimmest"] = part_dict(found.dimmest);
  d["walks"] = found.walks;
  d["segments"] = found.segments;
  d["given_up"] = found.given_up;
  d["seconds"] = found.seconds;
  d["guided"] = found.guided;
  d["disagreement"] = found.disagreement;
  return d;
}

py::dict path_dict(const PathReport& path) {
  py::dict d;
  d["cost"] = std::string(name_of(path.options.cost));
  d["solver"] = std::string(name_of(path.options.solver));
  d["cells"] = path.options.cells;
  d["size"] = py::make_tuple(path.size.x, path.size.y, path.size.z);
  d["cell"] = path.cell;
  d["solid"] = path.solid;
  d["lit"] = path.lit;
  d["rounds"] = path.rounds;
  return d;
}

}  // namespace

py::dict as_dict(const SolveReport& report) {
  py::dict d;
  d["method"] = std::string(name_of(report.method));
  d["solver"] = std::string(name_of(report.solver));
  d["source"] = std::string(name_of(report.source));
  d["model"] = std::string(name_of(report.model));
  d["cycles"] = report.cycles;
  py::list levels;
  for (const LevelReport& level : report.levels) levels.append(as_dict(level));
  d["levels"] = levels;
  d["walk_segments"] = report.walk_segments;
  d["energy"] = as_dict(report.energy);
  d["clipped"] = as_tuple(report.clipped);
  d["inter_reflection"] = report.inter_reflection;
  py::list bounces;
  for (const glm::dvec3& bounce : report.bounces) bounces.append(as_tuple(bounce));
  d["bounces"] = bounces;
  d["replaced"] = report.replaced;
  d["missed"] = report.missed;
  d["stopped"] = report.stopped;
  d["unmet"] = unmet(report);
  d["budget"] = report.budget;
  d["mesh_warning"] = report.mesh_warning;
  d["model_warning"] = report.model_warning;
  d["size_warning"] = report.size_warning;
  d["phase_warning"] = report.phase_warning;
  d["index_warning"] = report.index_warning;
  d["light_warning"] = report.light_warning;
  d["deformed"] = report.deformed;
  d["exchange_age"] = report.exchange_age;
  d["path"] = report.path ? py::object(path_dict(*report.path)) : py::object(py::none());
  d["correction"] = report.correction ? py::object(correction_dict(*report.correction)) : py::object(py::none());
  d["carried"] = report.carried ? py::object(py::float_(*report.carried)) : py::object(py::none());
  d["certificate"] = report.certificate ? py::object(certificate_dict(*report.certificate)) : py::object(py::none());
  d["finest"] = report.finest;
  d["work"] = report.work;
  d["algebraic"] = error_dict(report.algebraic);
  d["mesh_error"] = error_dict(report.mesh_error);
  d["model_error"] = error_dict(report.model_error);
  d["light_error"] = error_dict(report.light_error);
  d["phase_error"] = error_dict(report.phase_error);
  d["error"] = error_dict(report.error);
  d["advice"] = report.advice;
  return d;
}

namespace {

// C++ errors arrive as the classes of quadgraph.base.errors, so that Python code catches one family.
void register_errors() {
  py::register_exception_translator([](std::exception_ptr error) {
    const auto raise = [](const char* name, const std::exception& e) {
      // What is repeated of a file need not be UTF-8.
      const std::string_view said = e.what();
      const auto text = py::reinterpret_steal<py::str>(
          PyUnicode_DecodeUTF8(said.data(), static_cast<Py_ssize_t>(said.size()), "backslashreplace"));
      PyErr_SetObject(py::module_::import("quadgraph.base.errors").attr(name).ptr(), text.ptr());
    };
    try {
      if (error) std::rethrow_exception(error);
    } catch (const FormatError& e) {
      raise("FormatError", e);
    } catch (const InputError& e) {
      raise("InputError", e);
    } catch (const SolverError& e) {
      raise("SolverError", e);
    } catch (const DeviceError& e) {
      raise("DeviceError", e);
    }
  });
}

}  // namespace
}  // namespace quadgraph::python

PYBIND11_MODULE(_core, module) {
  module.doc() = "The QuadGraph engine: .qgraph reader, CPU reference solver, GPU simulation and renderer.";
  quadgraph::python::register_errors();
  quadgraph::python::bind_graph(module);
  quadgraph::python::bind_materials(module);
  quadgraph::python::bind_reference(module);
  quadgraph::python::bind_deformation(module);
  quadgraph::python::bind_path(module);
  quadgraph::python::bind_picture(module);
  quadgraph::python::bind_options(module);
  quadgraph::python::bind_engine(module);
  quadgraph::python::bind_lights(module);
  quadgraph::python::bind_live_objects(module);
  quadgraph::python::bind_fluence(module);
  quadgraph::python::bind_derivative(module);
  quadgraph::python::bind_scene(module);
  quadgraph::python::bind_values(module);
  quadgraph::python::bind_hand(module);
  quadgraph::python::bind_volume(module);
  quadgraph::python::bind_surface(module);
  quadgraph::python::bind_devices(module);
}
