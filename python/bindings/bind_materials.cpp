// Materials and the Fresnel quantities of the boundary.
#include <pybind11/stl.h>

#include "engine/optics/fresnel.h"
#include "engine/optics/material.h"
#include "python/bindings/bindings.h"
#include "shaders/material/material.h"
#include "shaders/material/optics.h"

namespace py = pybind11;

namespace quadgraph::python {

void bind_materials(py::module_& module) {
  py::class_<gpu::Material>(module, "Material", "A material field in object space; coefficients in 1/mm.")
      .def(py::init([](const std::string& text) { return parse_material(text); }), py::arg("text"),
           "From a name of material_names() or 'sigma_s_prime=2.0,sigma_a=0.01,eta=1.3' (one value or R/G/B each), "
           "or the colour of a thick body, 'reflectance=0.8/0.6/0.5,mean_free_path=0.5' (mm). "
           "Raises InputError.")
      .def_property_readonly("sigma_s_prime",
                             [](const gpu::Material& m) { return as_tuple(glm::dvec3(m.sigma_s_prime)); })
      .def_property_readonly("sigma_a", [](const gpu::Material& m) { return as_tuple(glm::dvec3(m.sigma_a)); })
      .def_readonly("eta", &gpu::Material::eta);
  module.attr("COEFFICIENT_MAX") = gpu::COEFFICIENT_MAX;
  module.def("material_names", &material_names, "Materials that have a name, in the order in which they are offered.");
  module.def("material_source", &material_source, py::arg("name"),
             "Where the coefficients of a material of that name are from, in words. Raises InputError.");
  module.def(
      "material_at",
      [](const gpu::Material& material, const FloatArray& points, const FloatArray& depths) {
        const auto count = static_cast<std::size_t>(depths.size());
        const std::span<const glm::vec3> places = vectors(points, count, "points");
        std::vector<gpu::Optical> optical;
        for (std::size_t i = 0; i < count; ++i)
          optical.push_back(gpu::material_at(material, places[i], depths.data()[i]));
        return coefficient_arrays(optical);
      },
      py::arg("material"), py::arg("points"), py::arg("depths"),
      "sigma_s_prime and sigma_a, (n, 3) in 1/mm, at (n, 3) mm, (n,) mm below the surface.");
  module.def(
      "fresnel_transmittance", [](double cos_i, double eta) { return fresnel_transmittance(cos_i, eta); },
      py::arg("cos_i"), py::arg("eta"), "Unpolarised transmittance from outside at incidence cosine cos_i.");
  module.def("internal_diffuse_reflectance", &internal_diffuse_reflectance, py::arg("eta"), "The published F_dr.");
  module.def("mismatch", &mismatch, py::arg("eta"), "A = (1 + F_dr) / (1 - F_dr).");
}

}  // namespace quadgraph::python
