// What the public Python classes hand over: values as JSON text in the form that scene files have (docs/scene.md), and
// volumes as arrays.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <map>

#include "engine/base/error.h"
#include "engine/base/json_text.h"
#include "engine/optics/material.h"
#include "engine/scene/light_json.h"
#include "engine/scene/scene.h"
#include "engine/scene/scene_file.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
Scene members(const std::string& text) {
  Json json = parse_json(text);
  if (!json.is_object()) throw InputError("a JSON object is wanted");
  if (!json.contains("body")) json["body"] = "";
  return scene_from(JsonField(json, ""));
}

View view_of(const Engine& engine, const std::string& json, const std::string& text) {
  View view = members(json).view;
  if (!parse_json(json).contains("/camera/azimuth"_json_pointer)) {
    view.azimuth = first_view(engine.graph().front(), view.up).azimuth;
  }
  return text.empty() ? view : parse_view(text, view);
}

namespace {

std::string material_json(const std::string& text) {
  const gpu::Material material = parse_material(text);
  Json json{{"sigma_s_prime", triple_json(material.sigma_s_prime)},
            {"sigma_a", triple_json(material.sigma_a)},
            {"eta", real_json(material.eta)},
            {"pattern", pattern_name(material)}};
  if (material.g != glm::vec3(0)) json["g"] = triple_json(material.g);
  if (material.pattern != gpu::PATTERN_NONE) {
    if (material.second_g != glm::vec3(0)) json["second_g"] = triple_json(material.second_g);
    json["second_sigma_s_prime"] = triple_json(material.second_sigma_s_prime);
    json["second_sigma_a"] = triple_json(material.second_sigma_a);
    json["period"] = real_json(material.period);
    json["sharpness"] = real_json(material.sharpness);
  }
  if (const auto roughness = stated_roughness(text)) json["roughness"] = real_json(*roughness);
  if (const Coat coat = stated_coat(text); coat.share > 0) {
    json["coat"] = real_json(coat.share);
    json["coat_eta"] = real_json(coat.eta);
    json["coat_roughness"] = real_json(coat.roughness);
  }
  return json.dump();
}

Picture render_members(Engine& engine, const std::string& json, const std::string& text, const py::object& told) {
  const View view = view_of(engine, json, text);
  const RenderOptions options = members(json).render;
  const auto tell = told_by(told);
  const py::gil_scoped_release release;
  return engine.render(view, options, tell);
}

void bind_pictures(py::module_& module) {
  module.def("render", &render_members, py::arg("engine"), py::arg("json"), py::arg("view") = "",
             py::arg("told") = py::none(),
             "As Engine.render, with the members `camera` and `picture` of a scene; view: a text in place of azimuth, "
             "elevation and distance. Raises InputError.");
}

}  // namespace

void bind_values(py::module_& module) {
  module.def(
      "light_json", [](const std::string& text) { return to_json(parse_light(text)).dump(); }, py::arg("text"),
      "A light's members, from the text that --light takes. Raises InputError.");
  module.def(
      "light_text",
      [](const std::string& json) {
        const Json light = parse_json(json);
        return to_string(light_from(JsonField(light, "light")));
      },
      py::arg("json"), "The text of a light, from its members. Raises InputError.");
  module.def("material_json", &material_json, py::arg("text"),
             "A material's members, in the shortest numbers, from the text that --material takes. Raises InputError.");
  module.def(
      "set_edits",
      [](Engine& engine, const std::string& json) { engine.set_edits(applied_edits(members(json).layers)); },
      py::arg("engine"), py::arg("json"), "The member `edits` of a scene. Raises InputError.");
  module.def(
      "set_normal_map",
      [](Engine& engine, const std::string& json) { engine.set_normal_map(members(json).render.normal_map); },
      py::arg("engine"), py::arg("json"),
      "The `normal_map` of the member `picture` of a scene, or none. Raises InputError.");
  module.def(
      "check_scene", [](const std::string& json) { members(json); }, py::arg("json"),
      "Raises InputError naming the place, unless scene files may have these members.");
  module.def("scene_file", &SceneFile::parse, py::arg("json"), py::arg("path") = std::filesystem::path(),
             "A SceneFile of a text; relative names are looked for beside `path`, which is not read, without one in "
             "the working directory. Raises InputError.");
  bind_pictures(module);
}

}  // namespace quadgraph::python
