// Scenes as values and as files, and the stage that shows them.
#include <pybind11/operators.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "engine/base/error.h"
#include "engine/scene/gestures.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/stage.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

void bind_scene_type(py::module_& module) {
  py::class_<Scene>(module, "Scene", "All that a user shows, as a value (docs/scene.md).")
      .def(py::init([](const std::filesystem::path& body) { return Scene{.body = body}; }), py::arg("body"))
      .def_readonly("body", &Scene::body)
      .def_readonly("material", &Scene::material)
      .def_property_readonly("lights",
                             [](const Scene& scene) {
                               std::vector<std::string> texts;
                               for (const Light& light : scene.lights) texts.push_back(to_string(light));
                               return texts;
                             })
      .def_property_readonly("size",
                             [](const Scene& scene) { return py::make_tuple(scene.render.width, scene.render.height); })
      .def(
          "with_deformation",
          [](Scene scene, const py::object& list) {
            scene.deformation = deformation_from(list);
            return scene;
          },
          py::arg("list"), "The same with another deformation, as Engine.set_deformation takes it. Raises InputError.")
      .def(
          "json", [](const Scene& scene) { return to_json(scene).dump(2); },
          "The text of a scene file that shows this.")
      .def(py::self == py::self);
}

void bind_scene_file(py::module_& module) {
  module.attr("MOST_FRAMES") = most_frames;
  py::class_<SceneFile>(module, "SceneFile", "A scene that may change from frame to frame (docs/scene.md).")
      .def(py::init(&SceneFile::load), py::arg("path"), "Raises InputError naming file, path into it, found, allowed.")
      .def(py::init<const Scene&>(), py::arg("scene"), "One that does not change.")
      .def_property_readonly("frames", &SceneFile::frames)
      .def_property_readonly("frames_per_second", &SceneFile::frames_per_second)
      .def("at", &SceneFile::at, py::arg("frame"), "The Scene of a frame, which need not be whole.")
      .def("set", &SceneFile::set, py::arg("pointer"), py::arg("value"),
           "Puts a JSON value at a JSON pointer; a text that is no JSON counts as a string. Raises InputError, and "
           "changes nothing, where the scene would be wrong.")
      .def("of_scene", &SceneFile::with, py::arg("scene"),
           "The same frames of another Scene, whose values its tracks change. Raises InputError.")
      .def("save", &SceneFile::save, py::arg("path"), "Raises InputError naming the file.");
}

py::tuple view_rays(Stage& stage, const DoubleArray& pixels) {
  if (pixels.ndim() != 2 || pixels.shape(1) != 2) throw InputError("pixels: allowed is the shape (n, 2)");
  const Scene& scene = stage.scene();
  const glm::dvec2 size(scene.render.width, scene.render.height);
  const Camera camera = place_camera(scene.view, stage.engine().bounds(), static_cast<float>(size.x / size.y));
  std::vector<glm::dvec3> from, along;
  for (py::ssize_t i = 0; i < pixels.shape(0); ++i) {
    const ViewRay ray = view_ray(camera, glm::vec2(2 * pixels.at(i, 0) / size.x - 1, 1 - 2 * pixels.at(i, 1) / size.y));
    from.push_back(ray.from);
    along.push_back(ray.along);
  }
  return py::make_tuple(own(std::move(from)), own(std::move(along)));
}

// The scene that is shown after what a hand did: camera or lights moved as in the window.
std::string after_gesture(Stage& stage, const std::string& name, float right, float up, std::size_t light) {
  Scene scene = stage.scene();
  const Sphere& bounds = stage.engine().bounds();
  const float aspect = static_cast<float>(scene.render.width) / static_cast<float>(scene.render.height);
  if (name == "orbit") {
    scene.view = orbited(scene.view, bounds, aspect, right, up);
  } else if (name == "pan") {
    scene.view = panned(scene.view, bounds, aspect, right, up);
  } else if (name == "zoom") {
    scene.view = zoomed(scene.view, bounds, aspect, up);
  } else if (name != "turn") {
    throw InputError("gesture: found '" + name + "', allowed are orbit, pan, zoom, turn");
  } else if (light >= scene.lights.size()) {
    throw InputError("light: found " + std::to_string(light) + ", the scene has " +
                     std::to_string(scene.lights.size()));
  } else {
    scene.lights[light] = turned(scene.lights[light], scene.view, bounds, right, up);
  }
  return to_json(scene).dump();
}

void bind_stage(py::module_& module) {
  py::class_<Stage>(module, "Stage", "An Engine that shows a Scene.")
      .def(py::init([](const std::string& device, bool validation) {
             return std::make_unique<Stage>(device::DeviceOptions{validation, device, nullptr, heed_signals});
           }),
           py::arg("device") = "", py::arg("validation") = false)
      .def("show", &Stage::show, py::arg("scene"), py::call_guard<py::gil_scoped_release>(),
           "Sets on the engine what differs. Raises FormatError, InputError, DeviceError.")
      .def(
          "solve",
          [](Stage& stage) {
            const SolveReport report = [&] {
              const py::gil_scoped_release release;
              return stage.solve(heed_signals);
            }();
            return as_dict(report);
          },
          "As Engine.solve, with the scene's options.")
      .def(
          "render",
          [](Stage& stage, const py::object& told) {
            const auto tell = told_by(told);
            const py::gil_scoped_release release;
            return stage.render(tell);
          },
          py::arg("told") = py::none(), "As Engine.render, with the scene's view and options.")
      .def(
          "srgb", [](Stage& stage, const Picture& picture) { return srgb_array(picture, stage.scene().tone); },
          py::arg("picture"), "(h, w, 3) uint8, with the scene's exposure and background.")
      .def(
          "write_png",
          [](Stage& stage, const Picture& picture, const std::filesystem::path& path) {
            write_png(path, picture, stage.scene().tone, stage.engine().metadata());
          },
          py::arg("picture"), py::arg("path"), "With the scene's exposure and background.")
      .def(
          "write_exr",
          [](Stage& stage, const Picture& picture, const std::filesystem::path& path) {
            write_exr(path, picture, stage.scene().tone, stage.engine().metadata());
          },
          py::arg("picture"), py::arg("path"), "Linear and not exposed.")
      .def("view_rays", &view_rays, py::arg("pixels"),
           "Rays through (n, 2) places of the scene's picture, counted in pixels right and down from its corner: where "
           "they come from, mm, and their unit directions, (n, 3) each. Raises InputError.")
      .def("after_gesture", &after_gesture, py::arg("name"), py::arg("right"), py::arg("up"), py::arg("light") = 0,
           "JSON of the scene after a hand moved its camera or a light: orbit and turn by degrees right and up, pan by "
           "shares of the picture's height, zoom in by `up` steps, an eighth of the distance each. Raises InputError.")
      .def_property_readonly("map_report", &Stage::map_report,
                             "What is to be said of the map that carried the material into the body; '' without one.")
      .def_property_readonly("scene", &Stage::scene)
      .def_property_readonly("engine", &Stage::engine, py::return_value_policy::reference_internal);
}

}  // namespace

void bind_scene(py::module_& module) {
  bind_scene_type(module);
  bind_scene_file(module);
  bind_stage(module);
}

}  // namespace quadgraph::python
