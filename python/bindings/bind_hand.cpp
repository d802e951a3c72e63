// What a hand does to a picture: which body it points at, strokes of the brush, layers.
#include <pybind11/stl.h>

#include <array>
#include <cmath>
#include <map>

#include "engine/base/error.h"
#include "engine/base/json_text.h"
#include "engine/reference/operator.h"
#include "engine/scene/edit_json.h"
#include "engine/scene/painting.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

py::object name_of_body(const QuadGraph& graph, const std::optional<Picked>& picked) {
  if (!picked) return py::none();
  return py::str(body_name(*picked, graph));
}

glm::vec2 place_from(double x, double y) {
  if (!std::isfinite(x) || !std::isfinite(y)) throw InputError("x, y: found no finite numbers, pixels are wanted");
  return {x, y};
}

py::object body_at(const Engine& engine, double x, double y, const std::string& json, const std::string& view) {
  Scene scene = members(json);
  scene.view = view_of(engine, json, view);
  const float aspect = static_cast<float>(scene.render.width) / static_cast<float>(scene.render.height);
  return name_of_body(engine.graph(), engine.pick(scene.view, aspect, clip_place(scene, place_from(x, y))));
}

std::string told(const Painted& made) {
  const glm::vec3& colour = made.look.colour;
  return Json{{"edits", layers_json(made.scene.layers)},
              {"layer", made.layer},
              {"touched", made.touched},
              {"colour", Json::array({real_json(colour.x), real_json(colour.y), real_json(colour.z)})},
              {"distance", real_json(made.look.distance)}}
      .dump();
}

std::string after_brush(Stage& stage, const std::string& json, const std::vector<std::array<double, 2>>& places,
                        bool begins) {
  const Json brush = parse_json(json);
  std::vector<glm::vec2> pixels;
  for (const auto& place : places) pixels.push_back(place_from(place[0], place[1]));
  return told(painted(stage, JsonField(brush, "brush"), pixels, begins));
}

std::string after_layer(Stage& stage, const std::string& json) {
  const Json asked = parse_json(json);
  return told(relayered(stage.scene(), JsonField(asked, "layers")));
}

std::vector<std::vector<std::array<float, 2>>> rings_of_brush(Stage& stage, const std::string& json, double x,
                                                              double y) {
  const Json brush = parse_json(json);
  std::vector<std::vector<std::array<float, 2>>> rings;
  for (const Ring& ring : brush_rings(stage, JsonField(brush, "brush"), place_from(x, y))) {
    auto& places = rings.emplace_back();
    for (const glm::vec2& place : ring) places.push_back({place.x, place.y});
  }
  return rings;
}

// By the names of Mirror, what a user calls the sides of the body.
std::map<std::string, std::string> mirrors_of_body(Stage& stage) {
  const auto names = mirror_names(stage.engine().graph().front(), stage.scene().view.up);
  std::map<std::string, std::string> sides;
  for (const auto& mirror : Names<Mirror>::values) {
    sides.emplace(mirror.name, names[static_cast<std::size_t>(mirror.value)]);
  }
  return sides;
}

std::vector<std::string> methods_of_body(Stage& stage) {
  const auto& levels = stage.engine().graph().levels();
  std::vector<std::string> names;
  if (!levels.empty()) {
    for (const Method method : methods_of(levels[0])) names.emplace_back(name_of(method));
  }
  names.emplace_back(name_of(Method::shortest_path));
  return names;
}

}  // namespace

void bind_hand(py::module_& module) {
  module.def(
      "body_at", &body_at, py::arg("engine"), py::arg("x"), py::arg("y"), py::arg("json"), py::arg("view") = "",
      "Name of the body that a picture shows at a place, pixels right and down from its corner, with the members "
      "`camera` and `picture` of a scene and a text in place of azimuth, elevation and distance; None beside "
      "them. Raises InputError.");
  module.def(
      "stage_body_at",
      [](Stage& stage, double x, double y) {
        return name_of_body(stage.engine().graph(), picked_at(stage, place_from(x, y)));
      },
      py::arg("stage"), py::arg("x"), py::arg("y"), "The same in the picture of the scene that a stage shows.");
  module.def(
      "after_brush", &after_brush, py::arg("stage"), py::arg("brush"), py::arg("places"), py::arg("begins"),
      "JSON of {edits, layer, touched, colour, distance} after a brush (engine/scene/painting.h) went over places "
      "of the picture, pixels. Raises InputError.");
  module.def(
      "brush_rings", &rings_of_brush, py::arg("stage"), py::arg("brush"), py::arg("x"), py::arg("y"),
      "Rings that show how far the brush reaches at a place of the picture, and on the other side by its mirror; "
      "all in pixels. Raises InputError.");
  module.def("mirrors_of_body", &mirrors_of_body, py::arg("stage"),
             "Names of the sides that a brush paints, by the values of its `mirror`.");
  module.def("after_layer", &after_layer, py::arg("stage"), py::arg("json"),
             "The same after a change of the layers (engine/scene/painting.h). Raises InputError.");
  module.def(
      "usual_brush", [](Stage& stage) { return to_json(Brush::for_body(stage.engine().bounds().radius)).dump(); },
      py::arg("stage"), "JSON of the brush that a body of that size has at first.");
  module.def("methods_of_body", &methods_of_body, py::arg("stage"),
             "Names of the methods that its file has levels for.");
}

}  // namespace quadgraph::python
