#include "engine/render/picture/metadata.h"

#include "engine/base/text.h"
#include "engine/optics/material.h"

namespace quadgraph {
namespace {

std::string joined(std::span<const Light> lights) {
  std::string text;
  for (const Light& light : lights) text += (text.empty() ? "" : " ") + to_string(light);
  return text.empty() ? "none" : text;
}

std::string orthographic_text(float height) {
  return height > 0 ? "orthographic, " + number_text(height) + " mm high" : "orthographic, all of the object";
}

std::string lens_text(const View& view) {
  if (view.aperture == 0) return "";
  const std::string place = view.focus ? number_text(*view.focus) + " mm ahead" : "the nearest of the object";
  return ", aperture " + number_text(view.aperture) + " mm, in focus " + place;
}

std::string camera_text(const View& view) {
  const std::string place =
      view.eye ? "eye " + place_text(*view.eye) + " looks at " + place_text(*view.look_at) : "view " + to_string(view);
  const std::string seen = view.orthographic ? orthographic_text(*view.orthographic)
                                             : "vertical field of view " + number_text(view.vertical_fov) + " degrees";
  return place + ", " + seen + ", " + (view.up == UpAxis::y ? "y" : "z") + " up" + lens_text(view);
}

// whole: what the whole is.
std::string parts_text(const char* whole, const ErrorEstimate& error) {
  return std::string(whole) + " " + number_text(static_cast<float>(error.whole)) + ", unlit part " +
         number_text(static_cast<float>(error.unlit)) + ", dimmest third " +
         number_text(static_cast<float>(error.dimmest));
}

std::string error_text(const std::optional<ErrorEstimate>& error) {
  return error ? parts_text("whole surface", *error) : "unknown (single level)";
}

std::string inter_reflection_text(const SolveOptions& options, const SolveReport& report) {
  if (!report.inter_reflection) {
    return bounces_wanted(options) ? "left out, the file does not say what the faces see (bake it again)" : "left out";
  }
  const glm::dvec3 share = report.energy.re_entered / glm::max(report.energy.entered, glm::dvec3(1e-300));
  return std::to_string(report.bounces.size()) + " bounces bring in " + rgb_text(glm::vec3(share)) +
         " of the light again";
}

std::string scattering_text(const std::string& prefix, const glm::vec3& sigma_s_prime, const glm::vec3& g) {
  const std::string known = g == glm::vec3(0) ? "" : "," + prefix + "g=" + rgb_text(g);
  return prefix + "sigma_s_prime=" + rgb_text(sigma_s_prime) + known;
}

}  // namespace

std::string material_text(const gpu::Material& material) {
  std::string text = scattering_text("", material.sigma_s_prime, material.g) +
                     ",sigma_a=" + rgb_text(material.sigma_a) + ",eta=" + number_text(material.eta);
  if (material.pattern != gpu::PATTERN_NONE) {
    text += ",pattern=" + std::string(pattern_name(material)) + "," +
            scattering_text("second_", material.second_sigma_s_prime, material.second_g) +
            ",second_sigma_a=" + rgb_text(material.second_sigma_a) + ",period=" + number_text(material.period) +
            ",sharpness=" + number_text(material.sharpness);
  }
  return text;
}

namespace {

void describe_view(const PictureFacts& facts, Metadata& metadata) {
  if (!facts.deformation.empty()) metadata.emplace_back("deformation", facts.deformation);
  if (!facts.report.deformed.empty()) metadata.emplace_back("deformed", facts.report.deformed);
  if (!facts.view) return;
  metadata.emplace_back("camera", camera_text(*facts.view));
  metadata.emplace_back("radiance", std::string(facts.radiance));
  if (facts.error) metadata.emplace_back("picture error", parts_text("whole picture", *facts.error));
}

std::string path_text(const PathReport& path) {
  std::string size;
  for (int axis = 0; axis < 3; ++axis) size += (axis > 0 ? " x " : "") + std::to_string(path.size[axis]);
  return std::to_string(path.solid) + " solid of " + size + " cells of " + number_text(path.cell) + " mm";
}

Metadata describe_path(const PictureFacts& facts) {
  const PathReport& path = *facts.report.path;
  Metadata metadata = {{"software", "quadgraph-engine"},
                       {"source", facts.source},
                       {"material", facts.material},
                       {"lights", joined(facts.lights)},
                       {"method", std::string(name_of(facts.report.method))},
                       {"path cost", std::string(name_of(path.options.cost))},
                       {"path solver", std::string(name_of(path.options.solver))},
                       {"voxels", path_text(path)},
                       {"error", "unknown (no error is estimated)"},
                       {"units", "W/(mm^2 sr)"},
                       {"device", facts.device.name + ", " + facts.device.driver}};
  describe_view(facts, metadata);
  return metadata;
}

}  // namespace

Metadata describe(const PictureFacts& facts) {
  if (facts.report.path) return describe_path(facts);
  const LevelReport& finest = facts.report.levels.back();
  Metadata metadata = {{"software", "quadgraph-engine"},
                       {"source", facts.source},
                       {"material", facts.material},
                       {"lights", joined(facts.lights)},
                       {"method", std::string(name_of(facts.report.method))},
                       {"model", std::string(name_of(facts.report.model))},
                       {"light enters", std::string(name_of(facts.report.source))},
                       {"solver", std::string(name_of(facts.report.solver))},
                       {"tolerance", number_text(facts.options.tolerance)},
                       {"unknowns", std::to_string(finest.unknowns)},
                       {"iterations", std::to_string(finest.iterations)},
                       {"residual", number_text(static_cast<float>(finest.residual))},
                       {"energy balance", rgb_text(glm::vec3(facts.report.energy.balance()))},
                       {"inter-reflection", inter_reflection_text(facts.options, facts.report)},
                       {"error", error_text(facts.report.error)},
                       {"units", "W/(mm^2 sr)"},
                       {"device", facts.device.name + ", " + facts.device.driver}};
  if (facts.report.correction) {
    const std::uint32_t solves = facts.options.mean_of;
    metadata.emplace_back("transport correction",
                          std::to_string(facts.report.correction->sweeps.size()) + " sweeps" +
                              (solves > 1 ? ", mean of " + std::to_string(solves) + " solves" : ""));
  }
  describe_view(facts, metadata);
  return metadata;
}

Metadata with_exposure(Metadata metadata, const Picture& picture, const ToneOptions& options) {
  metadata.emplace_back("exposure", number_text(exposure_of(picture, options)) + " stops");
  metadata.emplace_back("tone", std::string(name_of(options.curve)));
  metadata.emplace_back("white balance", number_text(options.white_balance) + " K");
  return metadata;
}

}  // namespace quadgraph
