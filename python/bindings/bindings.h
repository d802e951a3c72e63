// What the binding files share: one bind_* function per subsystem, and the gate between NumPy arrays and spans.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/deform/deformer.h"
#include "engine/file/graph.h"
#include "engine/reference/solution.h"
#include "engine/render/picture/picture.h"
#include "engine/scene/scene.h"
#include "shaders/shared/shared.h"

namespace quadgraph::python {

void bind_graph(pybind11::module_& module);
void bind_materials(pybind11::module_& module);
void bind_reference(pybind11::module_& module);
void bind_picture(pybind11::module_& module);
void bind_engine(pybind11::module_& module);
void bind_lights(pybind11::module_& module);
void bind_live_objects(pybind11::module_& module);
void bind_scene(pybind11::module_& module);
void bind_path(pybind11::module_& module);
void bind_deformation(pybind11::module_& module);
void bind_options(pybind11::module_& module);
void bind_fluence(pybind11::module_& module);
void bind_values(pybind11::module_& module);
void bind_hand(pybind11::module_& module);
void bind_volume(pybind11::module_& module);
void bind_surface(pybind11::module_& module);
void bind_derivative(pybind11::module_& module);
void bind_devices(pybind11::module_& module);

// Converted to C order and float32 if need be.
using IndexArray = pybind11::array_t<std::uint32_t, pybind11::array::c_style | pybind11::array::forcecast>;
using FloatArray = pybind11::array_t<float, pybind11::array::c_style | pybind11::array::forcecast>;

using DoubleArray = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

// A read-only array over memory that `owner` keeps alive.
template <typename Scalar>
pybind11::array view(const Scalar* data, std::vector<pybind11::ssize_t> shape, pybind11::handle owner) {
  pybind11::array_t<Scalar> array(std::move(shape), data, owner);
  array.attr("setflags")(pybind11::arg("write") = false);
  return array;
}

// Moves a vector into an array that owns it: (n,) for scalars, (n, 3) for vectors of three.
template <typename Scalar>
pybind11::array own(std::vector<Scalar>&& values) {
  auto* kept = new std::vector<Scalar>(std::move(values));
  const pybind11::capsule owner(kept, [](void* p) { delete static_cast<std::vector<Scalar>*>(p); });
  const auto n = static_cast<pybind11::ssize_t>(kept->size());
  if constexpr (std::is_arithmetic_v<Scalar>) {
    return pybind11::array_t<Scalar>({n}, kept->data(), owner);
  } else {
    using Component = typename Scalar::value_type;
    static_assert(sizeof(Scalar) == 3 * sizeof(Component));
    return pybind11::array_t<Component>({n, pybind11::ssize_t{3}}, reinterpret_cast<const Component*>(kept->data()),
                                        owner);
  }
}

// `array` as vectors of three; InputError naming `what` unless its shape is (count, 3).
std::span<const glm::vec3> vectors(const FloatArray& array, std::size_t count, const std::string& what);

// The same in double precision.
std::vector<glm::dvec3> vectors(const DoubleArray& array, std::size_t count, const std::string& what);

// Zips sigma_s_prime and sigma_a, (n, 3) in 1/mm, into one entry per node.
std::vector<gpu::Optical> optical_from(const FloatArray& sigma_s_prime, const FloatArray& sigma_a, std::size_t count);

// The way back: sigma_s_prime and sigma_a, (n, 3) each.
pybind11::tuple coefficient_arrays(std::span<const gpu::Optical> optical);

// Level `index`; IndexError if the file has fewer.
const Level& level_of(const QuadGraph& graph, std::uint32_t index);

// Throws InputError naming an option that is not allowed.
SolveOptions options_from(const std::string& method, const std::string& solver, const std::string& source,
                          const std::string& model, double tolerance, std::uint32_t max_iterations);

std::optional<glm::vec3> as_vector(const std::optional<std::array<float, 3>>& components);

// The scene of no body that has the members of this JSON text. Throws InputError.
Scene members(const std::string& json);

// The camera that `text` says, or that of the members; without an azimuth the body's front. Throws InputError.
View view_of(const Engine& engine, const std::string& json, const std::string& text);

pybind11::object error_dict(const std::optional<ErrorEstimate>& estimate);  // None: not known

// Calls a function of Python, unless it is None, with a dict for each step; from where the GIL is not held.
std::function<void(const ConvergenceStep&)> told_by(const pybind11::object& function);

// Tone mapped, (height, width, 3) sRGB.
pybind11::array_t<std::uint8_t> srgb_array(const Picture& picture, const ToneOptions& options);

// A list of dicts (docs/deformation.md), or its JSON text. Throws InputError.
std::vector<Deformer> deformation_from(const pybind11::object& list);

pybind11::tuple as_tuple(const glm::dvec3& v);
pybind11::dict as_dict(const Energy& energy);
pybind11::dict as_dict(const LevelReport& report);
pybind11::dict as_dict(const SolveReport& report);

// Throws KeyboardInterrupt where Ctrl-C has been pressed; called without the GIL.
void heed_signals();

}  // namespace quadgraph::python
