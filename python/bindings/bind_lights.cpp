#include <pybind11/stl.h>

#include "engine/render/light/default_lights.h"
#include "engine/scene/usual_light.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

View seen_from(const std::string& text, const std::string& up, float front, const std::string& eye,
               const std::string& look_at) {
  View view = first_view(front, from_name<UpAxis>(up));
  if (!text.empty()) view = parse_view(text, view);
  if (!eye.empty()) view.eye = parse_place(eye, "eye");
  if (!look_at.empty()) view.look_at = parse_place(look_at, "look-at");
  return view;
}

std::vector<std::string> light_texts(const std::vector<Light>& lights) {
  std::vector<std::string> texts;
  for (const Light& light : lights) texts.push_back(to_string(light));
  return texts;
}

std::vector<std::string> default_light_texts(const std::string& text, const std::string& up, float front,
                                             const std::string& eye, const std::string& look_at) {
  return light_texts(default_lights(seen_from(text, up, front, eye, look_at)));
}

py::tuple picture_light(const std::vector<std::string>& named, std::optional<bool> ground, const std::string& text,
                        const std::string& up, float front, const std::string& eye, const std::string& look_at) {
  Scene scene;
  const View view = seen_from(text, up, front, eye, look_at);
  scene.lights = named_lights(named, view);
  scene.render.ground = ground.value_or(false);
  light_unlit(scene, view, {.lights = !named.empty(), .ground = ground.has_value()});
  return py::make_tuple(light_texts(scene.lights), scene.render.ground);
}

}  // namespace

void bind_lights(py::module_& module) {
  const std::string usual_up(name_of(View{}.up));
  module.def("default_lights", &default_light_texts, py::arg("view") = "", py::arg("up") = usual_up,
             py::arg("front") = 0.0f, py::arg("eye") = "", py::arg("look_at") = "",
             "The lamps: a warm key from behind the object as `view` sees it (without one the azimuth `front`, "
             "degrees), a cool one from the side, a little ambient light.");
  module.def(
      "picture_light", &picture_light, py::arg("named"), py::arg("ground") = py::none(), py::arg("view") = "",
      py::arg("up") = usual_up, py::arg("front") = 0.0f, py::arg("eye") = "", py::arg("look_at") = "",
      "(lights, ground) of a picture with such --light texts, seen as by default_lights; none: what pictures have "
      "that nobody lit (engine/scene/usual_light.h). Raises InputError.");
}

}  // namespace quadgraph::python
