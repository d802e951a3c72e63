// What a body answers as a function of what it is made of, and its derivatives, in double precision.
#include <pybind11/stl.h>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/derivative/forward_model.h"
#include "engine/render/engine.h"
#include "engine/solve/etendue.h"
#include "engine/solve/fluence.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

// Of the bodies, whose indices these are. Throws InputError where they differ.
double one_index(std::span<const float> eta, const std::vector<std::string>& bodies) {
  for (std::size_t i = 1; i < eta.size(); ++i) {
    if (eta[i] == eta[0]) continue;
    throw InputError("derivatives: eta=" + number_text(eta[0]) + " found of '" + bodies[0] +
                     "' and eta=" + number_text(eta[i]) + " of '" + bodies[i] +
                     "', allowed is one index of refraction for all bodies: give both the same eta, or derive by a "
                     "file of one body");
  }
  return static_cast<double>(eta[0]);
}

void check_bare(std::span<const OpticalSurface> surfaces) {
  for (const OpticalSurface& surface : surfaces) {
    if (surface.rough()) {
      throw InputError("derivatives: a surface of roughness " + number_text(surface.roughness) +
                       " found, allowed is a smooth one: Engine.set_light_roughness(0), or a scene whose picture has a "
                       "transmission_roughness of 0");
    }
    if (surface.coat.share == 0) continue;
    throw InputError("derivatives: coat=" + number_text(surface.coat.share) +
                     " found, allowed is a bare surface: leave coat= out of the material");
  }
}

void check_within(const Simulation& simulation) {
  if (!simulation.etendue().bends()) return;
  throw InputError(
      "derivatives: found bodies within others with an index of refraction of their own, allowed is one index for all "
      "bodies: give them the eta of the body around them");
}

// The model and what it reads.
class BoundModel {
 public:
  BoundModel(Engine& engine, std::uint32_t number, const std::optional<DoubleArray>& scattering,
             const std::optional<DoubleArray>& absorption, const std::optional<DoubleArray>& power,
             std::vector<ViewSample> samples, ForwardOptions options)
      : level_(level_of(engine.graph(), number)) {
    Simulation& simulation = engine.simulation();
    if (!simulation.at_rest()) throw InputError("derivatives: the body is deformed, allowed is one at rest");
    beams_ = simulation.light_on(number);
    const std::vector<gpu::Optical> optical = tet_coefficients(engine.device(), simulation, number);
    Parameters at(level_.tets.size(), beams_.size());
    for (std::size_t t = 0; t < level_.tets.size(); ++t) {
      at.scattering[t] = glm::dvec3(optical[t].sigma_s_prime);
      at.absorption[t] = glm::dvec3(optical[t].sigma_a);
    }
    if (scattering) at.scattering = vectors(*scattering, level_.tets.size(), "sigma_s_prime");
    if (absorption) at.absorption = vectors(*absorption, level_.tets.size(), "sigma_a");
    at.power.assign(beams_.size(), glm::dvec3(1));
    if (power) at.power = vectors(*power, beams_.size(), "power");
    std::vector<BeamLight> lights;
    for (const LevelBeam& beam : beams_) lights.push_back({beam.way, beam.quarters});
    check_within(simulation);
    options.eta = one_index(simulation.eta(), engine.graph().bodies());
    check_bare(simulation.surfaces());
    options.check = heed_signals;
    const py::gil_scoped_release release;
    model_.emplace(level_, std::move(at), std::move(lights), std::move(samples), options);
  }

  py::tuple outgoing() const { return as_tuple(model_->outgoing()); }

  py::tuple parameters() const { return as_tuple(Parameters(model_->at())); }

  // Of all beams together, the mean over each face.
  py::array entering() const {
    std::vector<glm::dvec3> sum(level_.faces.size(), glm::dvec3(0));
    for (std::size_t i = 0; i < beams_.size(); ++i) {
      for (std::size_t f = 0; f < sum.size(); ++f) {
        for (const glm::vec3& quarter : beams_[i].quarters[f]) {
          sum[f] += model_->at().power[i] * glm::dvec3(quarter) / 4.0;
        }
      }
    }
    return own(std::move(sum));
  }

  py::tuple tangent(const DoubleArray& scattering, const DoubleArray& absorption, const DoubleArray& power) const {
    Parameters along(level_.tets.size(), beams_.size());
    along.scattering = vectors(scattering, level_.tets.size(), "sigma_s_prime");
    along.absorption = vectors(absorption, level_.tets.size(), "sigma_a");
    along.power = vectors(power, beams_.size(), "power");
    return as_tuple([&] {
      const py::gil_scoped_release release;
      return model_->tangent(along);
    }());
  }

  py::tuple adjoint(const DoubleArray& exitance, const DoubleArray& unscattered, const DoubleArray& radiance,
                    bool only_operator) const {
    Outgoing weights(level_.faces.size(), 0);
    weights.exitance = vectors(exitance, level_.faces.size(), "exitance");
    weights.unscattered = vectors(unscattered, level_.faces.size(), "unscattered");
    weights.radiance = vectors(radiance, model_->outgoing().radiance.size(), "radiance");
    Parameters gradient = [&] {
      const py::gil_scoped_release release;
      return model_->adjoint(weights, only_operator ? Dependence::only_operator : Dependence::all);
    }();
    return as_tuple(std::move(gradient));
  }

 private:
  static py::tuple as_tuple(Outgoing outgoing) {
    return py::make_tuple(own(std::move(outgoing.exitance)), own(std::move(outgoing.unscattered)),
                          own(std::move(outgoing.radiance)));
  }

  static py::tuple as_tuple(Parameters parameters) {
    return py::make_tuple(own(std::move(parameters.scattering)), own(std::move(parameters.absorption)),
                          own(std::move(parameters.power)));
  }

  const Level& level_;
  std::vector<LevelBeam> beams_;
  std::optional<ForwardModel> model_;
};

std::vector<ViewSample> samples_of(const std::vector<std::uint32_t>& faces, const DoubleArray& barycentric,
                                   const DoubleArray& outside) {
  const std::vector<glm::dvec3> places = vectors(barycentric, faces.size(), "barycentric");
  const std::vector<glm::dvec3> ways = vectors(outside, faces.size(), "direction");
  std::vector<ViewSample> samples;
  for (std::size_t i = 0; i < faces.size(); ++i) samples.push_back({faces[i], places[i], ways[i]});
  return samples;
}

}  // namespace

void bind_derivative(py::module_& module) {
  py::class_<BoundModel>(module, "ForwardModel",
                         "What a body answers as a function of what it is made of (engine/derivative/forward_model.h), "
                         "for the light of an engine's last solve. Arrays are float64, channels last.")
      .def(py::init([](Engine& engine, std::uint32_t level, const std::optional<DoubleArray>& scattering,
                       const std::optional<DoubleArray>& absorption, const std::optional<DoubleArray>& power,
                       const std::vector<std::uint32_t>& faces, const DoubleArray& barycentric,
                       const DoubleArray& direction, const std::string& model, bool bounces, double tolerance) {
             const ForwardOptions options{.model = from_name<Model>(model), .bounces = bounces, .tolerance = tolerance};
             return std::make_unique<BoundModel>(engine, level, scattering, absorption, power,
                                                 samples_of(faces, barycentric, direction), options);
           }),
           py::arg("engine"), py::arg("level"), py::arg("sigma_s_prime"), py::arg("sigma_a"), py::arg("power"),
           py::arg("faces"), py::arg("barycentric"), py::arg("direction"), py::arg("model"), py::arg("bounces"),
           py::arg("tolerance"), py::keep_alive<1, 2>(),
           "sigma_s_prime, sigma_a: (n_t, 3) 1/mm, or None for those of the last solve; power: (beams, 3), factors "
           "of its light, or None for 1; faces (n,), barycentric (n, 3) and direction (n, 3), unit, out of the body: "
           "view samples. Raises InputError, SolverError.")
      .def_property_readonly("outgoing", &BoundModel::outgoing,
                             "exitance (n_f, 3) and unscattered (n_f, 3), W/mm^2, radiance (n, 3), W/(mm^2 sr)")
      .def_property_readonly("parameters", &BoundModel::parameters,
                             "sigma_s_prime and sigma_a, (n_t, 3) 1/mm, power (beams, 3)")
      .def_property_readonly("entering", &BoundModel::entering, "(n_f, 3) W/mm^2 that lights send into each face")
      .def("tangent", &BoundModel::tangent, py::arg("sigma_s_prime"), py::arg("sigma_a"), py::arg("power"),
           "The derivative of `outgoing` along (n_t, 3), (n_t, 3) and (lights, 3). Raises InputError.")
      .def("adjoint", &BoundModel::adjoint, py::arg("exitance"), py::arg("unscattered"), py::arg("radiance"),
           py::arg("only_operator"),
           "The derivatives of the sum of `outgoing` times these weights by sigma_s_prime, sigma_a and power. "
           "only_operator: with the light that enters and what view rays meet held fixed. Raises InputError.");
}

}  // namespace quadgraph::python
