// The engine: one object, its material, lights, solution and picture on one device.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <map>

#include "engine/base/error.h"
#include "engine/base/json_text.h"
#include "engine/deform/motion.h"
#include "engine/device/copy_bandwidth.h"
#include "engine/device/device.h"
#include "engine/device/memory.h"
#include "engine/devices/open_device.h"
#include "engine/reference/tet_points.h"
#include "engine/render/engine.h"
#include "engine/scene/cut_json.h"
#include "engine/scene/measured_error.h"
#include "engine/scene/options.h"
#include "engine/scene/volume.h"
#include "python/bindings/bindings.h"
#include "python/bindings/scene_keywords.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

py::dict field_dict(SurfaceField&& field) {
  py::dict d;
  d["position"] = own(std::move(field.position));
  d["normal"] = own(std::move(field.normal));
  d["area"] = own(std::move(field.area));
  d["q"] = own(std::move(field.q));
  d["phi"] = own(std::move(field.phi));
  d["exitance"] = own(std::move(field.exitance));
  d["unscattered"] = own(std::move(field.unscattered));
  return d;
}

py::list memory_list(const Engine& engine) {
  std::vector<std::pair<std::string, std::uint64_t>> uses(engine.memory().begin(), engine.memory().end());
  std::stable_sort(uses.begin(), uses.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  py::list list;
  for (const auto& [purpose, bytes] : uses) {
    py::dict d;
    d["purpose"] = purpose;
    d["bytes"] = bytes;
    list.append(d);
  }
  return list;
}

py::list as_list(const std::vector<PassStats>& passes) {
  py::list list;
  for (const PassStats& pass : passes) {
    py::dict d;
    d["name"] = pass.name;
    d["time_ms"] = pass.time_ms;
    d["bytes"] = pass.bytes;
    d["count"] = pass.count;
    list.append(d);
  }
  return list;
}

std::unique_ptr<Engine> make_engine(const std::filesystem::path& path, const std::string& device, bool validation) {
  return std::make_unique<Engine>(path, device::DeviceOptions{validation, device, nullptr, heed_signals});
}

void set_lights(Engine& engine, const std::vector<std::string>& texts) {
  std::vector<Light> lights;
  for (const std::string& text : texts) lights.push_back(parse_light(text));
  engine.set_lights(std::move(lights));
}

std::vector<gpu::Optical> optical_in_cells(const FloatArray& sigma_s_prime, const FloatArray& sigma_a) {
  const auto count = static_cast<std::size_t>(sigma_s_prime.size()) / 3;
  if (sigma_s_prime.shape(3) != 3 || sigma_a.size() != sigma_s_prime.size()) {
    throw InputError("sigma_s_prime and sigma_a: two arrays (nz, ny, nx, 3) are wanted");
  }
  const auto* scattering = reinterpret_cast<const glm::vec3*>(sigma_s_prime.data());
  const auto* absorption = reinterpret_cast<const glm::vec3*>(sigma_a.data());
  std::vector<gpu::Optical> optical;
  for (std::size_t i = 0; i < count; ++i) optical.push_back({scattering[i], absorption[i]});
  return optical;
}

// Those of the simulation, which corrects what it is asked to; what scenes have by default is the callers' to say.
SolveOptions solve_options(const char* function, const py::kwargs& given) {
  SolveOptions options = scene_of(function, given, {solver_group, path_group}).solve;
  if (!given.contains("correction")) options.correction = SolveOptions{}.correction;
  return options;
}

py::dict solve(Engine& engine, bool motion, const py::kwargs& given) {
  const SolveOptions options = solve_options("solve", given);
  const SolveReport report = [&] {
    const py::gil_scoped_release release;
    return solve_measured(engine, motion ? in_motion(options, engine.graph().levels()) : options, heed_signals);
  }();
  return as_dict(report);
}

void make_room(Engine& engine, const py::kwargs& given) {
  const SolveOptions options = solve_options("make_room", given);
  const py::gil_scoped_release release;
  engine.make_room(options);
}

View view_from(const std::string& text, const std::string& up, float vertical_fov, float front) {
  View view = first_view(front, from_name<UpAxis>(up));
  view.vertical_fov = vertical_fov;
  return text.empty() ? view : parse_view(text, view);
}

Scene pictured(Engine& engine, const std::string& view, const py::kwargs& given) {
  Scene scene = scene_of("render", given, {camera_group, picture_group});
  if (view.empty()) {
    scene.view.azimuth = first_view(engine.graph().front(), scene.view.up).azimuth;
  } else {
    scene.view = parse_view(view, scene.view);
  }
  return scene;
}

Picture render(Engine& engine, const std::string& view, const py::object& told, const py::kwargs& given) {
  const Scene scene = pictured(engine, view, given);
  const py::gil_scoped_release release;
  return engine.render(scene.view, scene.render, told_by(told));
}

void draw(Engine& engine, const std::string& view, const py::kwargs& given) {
  const Scene scene = pictured(engine, view, given);
  const py::gil_scoped_release release;
  engine.draw(scene.view, scene.render);
}

py::object pick(const Engine& engine, const std::array<float, 2>& at, const std::string& view, const std::string& up,
                float vertical_fov, float aspect, const std::optional<float>& orthographic) {
  View seen_from = view_from(view, up, vertical_fov, engine.graph().front());
  seen_from.orthographic = orthographic;
  const auto found = engine.pick(seen_from, aspect, {at[0], at[1]});
  if (!found) return py::none();
  py::dict d;
  d["position"] = as_tuple(glm::dvec3(found->position));
  d["at_rest"] = as_tuple(glm::dvec3(found->at_rest));
  d["normal"] = as_tuple(glm::dvec3(found->normal));
  return d;
}

py::dict leaving(Engine& engine, const IndexArray& face, const FloatArray& direction) {
  const auto count = static_cast<std::size_t>(face.size());
  Leaving light = engine.leaving({face.data(), count}, vectors(direction, count, "direction"));
  py::dict result;
  result["radiance"] = own(std::move(light.radiance));
  result["transmittance"] = own(std::move(light.transmittance));
  return result;
}

py::dict copy_bandwidth(const std::string& device) {
  const std::shared_ptr<device::Device> opened = open_device({false, device, nullptr});
  const device::CopyBandwidth copied = [&] {
    const py::gil_scoped_release release;
    return device::copy_bandwidth(*opened, device::default_copy_bytes(*opened));
  }();
  py::dict d;
  d["device"] = opened->info().name;
  d["driver"] = opened->info().driver;
  d["gb_per_s"] = copied.gb_per_s;
  d["kernel"] = copied.kernel;
  d["transfer"] = copied.transfer;
  d["bytes"] = copied.bytes;
  return d;
}

std::string solve_help() {
  return "Solves for the present material and light; a report. motion: as the window does while something changes "
         "(docs/window.md), whatever the other options say of it. Raises InputError, SolverError. Keywords:" +
         keywords_help({solver_group, path_group});
}

std::string render_help() {
  return "The last solve as a picture, seen from `view`, else from the front; told: is called with a dict after each "
         "step of a picture that converges. Raises InputError. Keywords:" +
         keywords_help({camera_group, picture_group});
}

// The body as users see it: material, lights, deformation.
void bind_scene_setters(py::class_<Engine>& bound) {
  bound
      .def(
          "set_material", [](Engine& engine, std::string_view text) { return set_material(engine, text); },
          py::arg("text"),
          "As --material reads it; returns what is said of a volume's map, or ''. Raises InputError, FormatError.")
      .def(
          "set_materials",
          [](Engine& engine, const std::map<std::string, std::string>& materials, const std::string& others) {
            set_materials(engine, others, materials);
          },
          py::arg("materials"), py::arg("others"),
          "Texts as set_material takes them by the names of bodies, that of the others. Raises InputError.")
      .def(
          "set_material", [](Engine& engine, const gpu::Material& material) { engine.set_material(material); },
          py::arg("material"))
      .def("set_lights", &set_lights, py::arg("lights"),
           "Texts as --light takes them (engine/render/light/lights.h); replaces all lights.")
      .def(
          "set_placements",
          [](Engine& engine, const std::string& json) {
            const BodyPoses poses = members(json).placements;
            const py::gil_scoped_release release;
            engine.set_placements(poses);
          },
          py::arg("json"), "The member `placements` of a scene. Raises InputError, and moves nothing.")
      .def(
          "set_deformation",
          [](Engine& engine, const py::object& list) {
            const std::vector<Deformer> deformers = deformation_from(list);
            const py::gil_scoped_release release;
            engine.set_deformation(deformers);
          },
          py::arg("list"),
          "Moves body and display mesh from where they lie in the file: a list of dicts with 'type' twist, bend, "
          "taper, stretch, transform, lattice, cage or displaced and the fields of docs/deformation.md (mm, degrees), "
          "or its "
          "JSON text; [] puts all back exactly. Material and what the body sees of itself follow. Raises InputError, "
          "and moves nothing.");
}

// What tests and studies give level by level in place of material and lights.
void bind_level_setters(py::class_<Engine>& bound) {
  bound
      .def(
          "set_irradiance",
          [](Engine& engine, std::uint32_t level, const FloatArray& q,
             const std::optional<std::array<float, 3>>& direction) {
            const Level& of = level_of(engine.graph(), level);
            engine.set_irradiance(level, vectors(q, of.face_count(), "q"), as_vector(direction));
          },
          py::arg("level"), py::arg("q"), py::arg("direction") = py::none(),
          "q (n_f, 3) in W/mm^2, the irradiance that the surface lets in, instead of lights; wanted for every level. "
          "direction (3,): the way it travels outside; None: Lambertian.")
      .def(
          "set_optical",
          [](Engine& engine, std::uint32_t level, const FloatArray& sigma_s_prime, const FloatArray& sigma_a, float eta,
             const std::optional<std::pair<FloatArray, FloatArray>>& elsewhere) {
            const Level& of = level_of(engine.graph(), level);
            std::vector<gpu::Optical> there;
            if (elsewhere) there = optical_from(elsewhere->first, elsewhere->second, points_of_a_tet * of.tet_count());
            engine.set_optical(level, optical_from(sigma_s_prime, sigma_a, of.node_count()), eta, there);
          },
          py::arg("level"), py::arg("sigma_s_prime"), py::arg("sigma_a"), py::arg("eta"),
          py::arg("elsewhere") = py::none(),
          "Coefficients per node, (n, 3) in 1/mm, instead of a material; wanted for every level. elsewhere: both at "
          "points_in_tets, by which the error of having one value in each tet is told; looked at of the finest level.")
      .def(
          "set_vertices",
          [](Engine& engine, std::uint32_t level, const FloatArray& positions) {
            const Level& of = level_of(engine.graph(), level);
            engine.simulation().set_vertices(level, vectors(positions, of.vertex_count(), "positions"));
          },
          py::arg("level"), py::arg("positions"),
          "Moves the vertices of a level, (n_v, 3) mm, and the material with them; light given by set_irradiance "
          "stays, lights are evaluated again by update_irradiance. Raises InputError, and moves nothing, where a tet "
          "would be "
          "turned inside out.");
}

// What only shortest-path takes.
void bind_shortest_path(py::class_<Engine>& bound) {
  bound
      .def(
          "set_grid",
          [](Engine& engine, const FloatArray& sigma_s_prime, const FloatArray& sigma_a,
             const std::array<float, 3>& spacing, const std::array<float, 3>& first, float eta) {
            if (sigma_s_prime.ndim() != 4) throw InputError("sigma_s_prime: an array (nz, ny, nx, 3) is wanted");
            const auto side = [&](int axis) { return static_cast<std::uint32_t>(sigma_s_prime.shape(axis)); };
            const std::vector<gpu::Optical> optical = optical_in_cells(sigma_s_prime, sigma_a);
            engine.set_optical(OpticalGrid{.size = {side(2), side(1), side(0)},
                                           .optical = optical,
                                           .spacing = {spacing[0], spacing[1], spacing[2]},
                                           .first = {first[0], first[1], first[2]},
                                           .eta = eta});
          },
          py::arg("sigma_s_prime"), py::arg("sigma_a"), py::arg("spacing"), py::arg("first"), py::arg("eta"),
          "Coefficients (nz, ny, nx, 3), 1/mm, at points `spacing` (3,) mm apart along x, y, z from `first` (3,) on, "
          "in the body at rest: what shortest-path takes in place of a material. The other methods keep theirs.")
      .def("set_light_roughness", &Engine::set_light_roughness, py::arg("alpha"), "GGX; None: the material's.")
      .def(
          "set_cuts",
          [](Engine& engine, const std::string& json) {
            const Json list = parse_json(json);
            std::vector<BodyCut> cuts;
            for (const JsonField& cut : JsonField(list, "cuts").items()) cuts.push_back(cut_from(cut));
            engine.set_cuts(cuts);
          },
          py::arg("json"),
          "What shortest-path cuts away, in the shape as it is shown: the JSON text of a list as in a scene file "
          "(docs/shortest-path.md). Raises InputError.");
}

// What the last solve found, on the surface.
void bind_surface_results(py::class_<Engine>& bound) {
  bound
      .def(
          "exitance_at",
          [](const Engine& engine, const FloatArray& points) {
            const auto count = static_cast<std::size_t>(points.ndim() == 2 ? points.shape(0) : 0);
            return own(engine.exitance_at(vectors(points, count, "points")));
          },
          py::arg("points"),
          "What leaves the surface at points (n, 3), mm, by the last solve with shortest-path; (n, 3) W/mm^2.")
      .def(
          "surface_field", [](const Engine& engine) { return field_dict(engine.surface_field()); },
          "Per outside face of level 0: position, normal, area, q, phi, exitance of scattered and of unscattered light "
          "(mm, mm^2, W/mm^2).")
      .def(
          "vertex_exitance",
          [](Engine& engine) {
            return own(device::download<glm::vec3>(engine.device(), engine.simulation().vertex_exitance()));
          },
          "Per surface vertex of level 0, W/mm^2: what a picture shows, local means of the scattered light.")
      .def(
          "vertex_unscattered",
          [](Engine& engine) {
            return own(device::download<glm::vec3>(engine.device(), engine.simulation().vertex_unscattered()));
          },
          "The same of light that left without having scattered.");
}

// What is seen of the last solve.
void bind_views(py::class_<Engine>& bound) {
  const std::string usual_up(name_of(View{}.up));
  bound
      .def("pick", &pick, py::arg("at"), py::arg("view") = "", py::arg("up") = usual_up,
           py::arg("vertical_fov") = View{}.vertical_fov, py::arg("aspect") = 1.0f,
           py::arg("orthographic") = std::optional<float>(),
           "What a picture of this view and shape shows at (x, y), -1 to 1 from left to right and from bottom to top: "
           "position, at_rest (mm; edits are placed by it) and normal; None where there is nothing.")
      .def("leaving", &leaving, py::arg("face"), py::arg("direction"),
           "Gathered radiance, W/(mm^2 sr), that leaves the centroids of outside faces (n,) of level 0 along unit "
           "outward directions (n, 3): radiance (n, 3) of scattered light, transmittance (n, 3) of the body.")
      .def(
          "phi", [](Engine& engine) { return own(engine.simulation().phi()); }, "Per carrier of level 0, W/mm^2.")
      .def("render", &render, py::arg("view") = "", py::arg("told") = py::none(), render_help().c_str())
      .def("draw", &draw, py::arg("view") = "",
           "What `render` does, with the same keywords, but the picture stays on the device.");
}

// What the engine says of itself: device, memory, time per pass.
void bind_measures(py::class_<Engine>& bound) {
  bound
      .def_property_readonly(
          "passes", [](const Engine& engine) { return as_list(engine.passes()); },
          "Device time and bytes per pass of the last frame.")
      .def_property_readonly("metadata", &Engine::metadata)
      .def_property_readonly("device_bytes", &Engine::device_bytes)
      .def("make_room", &make_room,
           "Allocates what a solve for the present material and light with these options of `solve`, and a picture of "
           "it, will take.")
      .def_property_readonly("allocation_count", &Engine::allocation_count,
                             "Allocations of device memory ever made; staging for large arrays among them.")
      .def("memory", &memory_list, "What device_bytes consists of: {purpose, bytes}, largest first.")
      .def_property_readonly("peak_device_bytes", &Engine::peak_device_bytes)
      .def_property_readonly("device_name", [](const Engine& engine) { return engine.device().info().name; })
      .def_property_readonly("driver", [](const Engine& engine) { return engine.device().info().driver; })
      .def_property_readonly("validation_messages",
                             [](const Engine& engine) { return engine.device().validation_messages(); });
}

}  // namespace

void heed_signals() {
  const py::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void bind_engine(py::module_& module) {
  module.def(
      "copy_bandwidth", &copy_bandwidth, py::arg("device") = "",
      "GB/s, read and written, at which a device copies one buffer into another: kernel (a compute pass), transfer "
      "(the driver's own copy), gb_per_s (the faster); bytes of each buffer; device, driver. Raises DeviceError.");
  py::class_<Engine> bound(module, "Engine", "A .qgraph on a device.");
  bound
      .def(py::init(&make_engine), py::arg("path"), py::arg("device") = "", py::arg("validation") = false,
           "device: cpu, or part of a Vulkan device's name; empty: a GPU, else cpu. validation: of Vulkan devices, by "
           "its layer. Raises FormatError, InputError, DeviceError.")
      .def_property_readonly("graph", &Engine::graph, py::return_value_policy::reference_internal)
      .def("update_irradiance", &Engine::update_irradiance, py::call_guard<py::gil_scoped_release>())
      .def("solve", &solve, py::kw_only(), py::arg("motion") = false, solve_help().c_str());
  bind_scene_setters(bound);
  bind_level_setters(bound);
  bind_shortest_path(bound);
  bind_surface_results(bound);
  bind_views(bound);
  bind_measures(bound);
}

}  // namespace quadgraph::python
