// A picture: its layers, and what becomes of them in a file.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "engine/base/error.h"
#include "engine/render/engine.h"
#include "engine/render/light/image_file.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

py::array pixels(const Picture& picture, const std::vector<float>& values, py::ssize_t channels, py::handle owner) {
  std::vector<py::ssize_t> shape = {picture.height, picture.width};
  if (channels > 1) shape.push_back(channels);
  return view(values.data(), std::move(shape), owner);
}

Picture picture_of(const FloatArray& radiance, const std::optional<FloatArray>& alpha,
                   const std::optional<FloatArray>& transmittance) {
  if (radiance.ndim() != 3 || radiance.shape(2) != 3 || radiance.size() == 0) {
    throw InputError("radiance: an array (h, w, 3) is wanted");
  }
  if (alpha && 3 * alpha->size() != radiance.size()) throw InputError("alpha: an array (h, w) is wanted");
  if (transmittance && transmittance->size() != radiance.size()) {
    throw InputError("transmittance: an array (h, w, 3) is wanted");
  }
  Picture picture;
  picture.width = static_cast<std::uint32_t>(radiance.shape(1));
  picture.height = static_cast<std::uint32_t>(radiance.shape(0));
  picture.scattered.assign(radiance.data(), radiance.data() + radiance.size());
  const std::vector<float> nothing(picture.scattered.size());
  picture.specular = picture.unscattered = picture.transmittance = nothing;
  if (transmittance) picture.transmittance.assign(transmittance->data(), transmittance->data() + transmittance->size());
  if (alpha) picture.alpha.assign(alpha->data(), alpha->data() + alpha->size());
  for (std::size_t i = 0; i < picture.scattered.size() && !alpha; i += 3) {
    const float* rgb = &picture.scattered[i];
    picture.alpha.push_back(rgb[0] > 0 || rgb[1] > 0 || rgb[2] > 0 ? 1.0f : 0.0f);
  }
  return picture;
}

py::dict step_dict(const ConvergenceStep& step) {
  py::dict d;
  d["solves"] = step.solves;
  d["sweeps"] = step.sweeps;
  d["points"] = step.points;
  d["samples"] = step.samples;
  d["seconds"] = step.seconds;
  d["error"] = error_dict(step.error);
  d["noise"] = step.noise;
  return d;
}

py::object convergence_dict(const std::optional<Convergence>& convergence) {
  if (!convergence) return py::none();
  py::dict d;
  d["wanted"] = convergence->wanted;
  d["reached"] = convergence->reached;
  d["out_of_time"] = convergence->out_of_time;
  d["least"] = convergence->least;
  d["limit"] = convergence->limit;
  py::list steps;
  for (const ConvergenceStep& step : convergence->steps) steps.append(step_dict(step));
  d["steps"] = steps;
  d["solve"] = as_dict(convergence->solve);
  return d;
}

// An RGB layer that a picture need not have.
template <std::vector<float> Picture::* layer>
py::object layer_or_none(py::object self) {
  const auto& picture = self.cast<const Picture&>();
  if ((picture.*layer).empty()) return py::none();
  return pixels(picture, picture.*layer, 3, self);
}

// One of the RGB layers of a picture.
template <std::vector<float> Picture::* layer>
py::array rgb_layer(py::object self) {
  const auto& picture = self.cast<const Picture&>();
  return pixels(picture, picture.*layer, 3, self);
}

void bind_image(py::module_& module) {
  module.def(
      "read_image",
      [](const std::filesystem::path& path) {
        const Image image = read_image(path);
        const auto* values = reinterpret_cast<const float*>(image.texels.data());
        return py::array_t<float>({py::ssize_t{image.height}, py::ssize_t{image.width}, py::ssize_t{3}}, values);
      },
      py::arg("path"),
      "(h, w, 3) float32, linear, top row first: of .exr, .hdr, or .png, whose sRGB is decoded and whose alpha is left "
      "out. Raises InputError.");
  module.def(
      "read_channels",
      [](const std::filesystem::path& path,
         const std::vector<std::string>& names) -> std::optional<py::array_t<float>> {
        if (names.empty() || names.size() > 3) throw InputError("names: one to three are wanted");
        const std::optional<Image> image = read_exr_channels(path, names);
        if (!image) return std::nullopt;
        const auto count = static_cast<py::ssize_t>(names.size());
        py::array_t<float> found({py::ssize_t{image->height}, py::ssize_t{image->width}, count});
        float* value = found.mutable_data();
        for (const glm::vec3& texel : image->texels) {
          for (py::ssize_t c = 0; c < count; ++c) *value++ = texel[static_cast<int>(c)];
        }
        return found;
      },
      py::arg("path"), py::arg("names"),
      "(h, w, len(names)) float32, top row first: one to three channels of an .exr, what is below 0 as 0; None where "
      "one "
      "is not there. Raises InputError.");
}

}  // namespace

std::function<void(const ConvergenceStep&)> told_by(const py::object& function) {
  if (function.is_none()) return {};
  return [&function](const ConvergenceStep& step) {
    const py::gil_scoped_acquire held;
    function(step_dict(step));
  };
}

py::array_t<std::uint8_t> srgb_array(const Picture& picture, const ToneOptions& options) {
  const std::vector<std::uint8_t> rgb = to_srgb8(picture, options);
  py::array_t<std::uint8_t> array({py::ssize_t{picture.height}, py::ssize_t{picture.width}, py::ssize_t{3}});
  std::copy(rgb.begin(), rgb.end(), array.mutable_data());
  return array;
}

py::dict shown_with(const Picture& picture, const std::string& json) {
  const ToneOptions options = members(json).tone;
  const gpu::ToneTransform tone = tone_transform(options, exposure_of(picture, options));
  py::array_t<float> matrix({3, 3});
  const std::array<glm::vec3, 3> rows = {tone.red, tone.green, tone.blue};
  for (int row = 0; row < 3; ++row) {
    for (int c = 0; c < 3; ++c) matrix.mutable_at(row, c) = rows[static_cast<std::size_t>(row)][c];
  }
  py::dict d;
  d["matrix"] = matrix;
  d["background_top"] = std::array{options.background_top.x, options.background_top.y, options.background_top.z};
  d["background_bottom"] =
      std::array{options.background_bottom.x, options.background_bottom.y, options.background_bottom.z};
  d["transparent"] = options.transparent;
  d["false_colour"] = picture.false_colour;
  return d;
}

void bind_picture(py::module_& module) {
  bind_image(module);
  py::class_<Picture>(module, "Picture", "Linear radiance in W/(mm^2 sr), premultiplied by alpha; top row first.")
      .def(py::init(&picture_of), py::arg("radiance"), py::arg("alpha") = py::none(),
           py::arg("transmittance") = py::none(),
           "From radiance, (h, w, 3), all of it scattered; alpha, (h, w), None: covered where there is any; and the "
           "share "
           "of what is behind that is seen through, (h, w, 3), None: none. Raises InputError.")
      .def(
          "auto_exposure",
          [](const Picture& picture, const std::string& json) { return auto_exposure(picture, members(json).tone); },
          py::arg("json") = "{}", "Stops that the exposure 'auto' takes. Raises InputError.")
      .def_property_readonly(
          "error", [](const Picture& picture) { return error_dict(picture.error); },
          "Of scattered light, relative RMS over pixels: {whole, unlit, dimmest}; None where it is not known.")
      .def_property_readonly("scattered", &rgb_layer<&Picture::scattered>,
                             "(h, w, 3): light that was scattered in the body.")
      .def_property_readonly("specular", &rgb_layer<&Picture::specular>, "(h, w, 3): light reflected by the surface.")
      .def_property_readonly("unscattered", &rgb_layer<&Picture::unscattered>,
                             "(h, w, 3): light that crossed the body without being scattered.")
      .def_property_readonly("transmittance", &rgb_layer<&Picture::transmittance>,
                             "(h, w, 3): share of what is behind the body that is seen through it.")
      .def_property_readonly(
          "alpha",
          [](py::object self) {
            const auto& picture = self.cast<const Picture&>();
            return pixels(picture, picture.alpha, 1, self);
          },
          "(h, w): share of the pixel that the object covers.")
      .def_property_readonly(
          "convergence", [](const Picture& picture) { return convergence_dict(picture.convergence); },
          "How it came to the error that was asked for, None where none was: {wanted, reached, out_of_time, least, "
          "limit, "
          "steps}.")
      .def_property_readonly(
          "standard_error", &layer_or_none<&Picture::standard_error>,
          "(h, w, 3): of the sum of the layers, of a picture that is the mean of several, else None.")
      .def_property_readonly(
          "surroundings", &layer_or_none<&Picture::surroundings>,
          "(h, w, 3), W/(mm^2 sr): what is behind the body where environment lights are seen, else None.")
      .def(
          "srgb",
          [](const Picture& picture, const std::string& json) { return srgb_array(picture, members(json).tone); },
          py::arg("json") = "{}",
          "Tone mapped, (h, w, 3) uint8 sRGB, with the member `picture` of a scene. Raises InputError.")
      .def("shown_with", &shown_with, py::arg("json") = "{}",
           "What srgb does around the tone curve: {matrix (3, 3) of exposure and white balance, background_top and "
           "background_bottom, linear, transparent, false_colour}. Raises InputError.")
      .def(
          "write_png",
          [](const Picture& picture, const std::filesystem::path& path, const Metadata& metadata,
             const std::string& json) { write_png(path, picture, members(json).tone, metadata); },
          py::arg("path"), py::arg("metadata") = Metadata{}, py::arg("json") = "{}")
      .def(
          "write_exr",
          [](const Picture& picture, const std::filesystem::path& path, const Metadata& metadata,
             const std::string& json) { write_exr(path, picture, members(json).tone, metadata); },
          py::arg("path"), py::arg("metadata") = Metadata{}, py::arg("json") = "{}",
          "Linear and not exposed; what it would be shown with is only noted in its attributes.");
}

}  // namespace quadgraph::python
