#include "engine/solve/coefficients.h"

#include <algorithm>
#include <bit>
#include <string>

#include "engine/base/error.h"
#include "engine/device/commands.h"
#include "engine/file/geometry.h"
#include "engine/optics/depth.h"
#include "engine/optics/material.h"
#include "engine/optics/model.h"
#include "engine/reference/operator.h"
#include "engine/reference/tet_points.h"
#include "engine/solve/assembly.h"
#include "interface/material/optical_range.comp.h"
#include "shaders/material/material.h"

namespace quadgraph {

namespace {

device::Buffer room(device::Device& device, std::uint32_t number, std::uint64_t count) {
  return {device, count * sizeof(gpu::Optical), device::Place::device,
          "material/level " + std::to_string(number) + " optical"};
}

}  // namespace

Coefficients::Coefficients(device::Device& device, std::span<const Level> rest, Refractions& refractions)
    : device_(device),
      refractions_(refractions),
      rest_(rest),
      given_(rest.size()),
      depth_(rest.size()),
      depth_buffers_(rest.size()),
      spacing_(rest.size()),
      albedo_(rest.size()),
      sampled_(rest.size()) {}

void Coefficients::changed() {
  evaluated_.reset();
  edited_.reset();
  elsewhere_.reset();
}

void Coefficients::set(const gpu::Material& material) {
  check_material(material);
  material_ = material;
  angles_ = angles_of(material);
  given_elsewhere_.clear();
  for (device::Buffer& given : given_) given = {};
  changed();
  refractions_.set({&material.eta, 1});
  std::fill(albedo_.begin(), albedo_.end(), least_albedo(material));
  rounding_ = quadgraph::packed_rounding(material, spacing(0));
}

void Coefficients::set(std::uint32_t number, std::span<const gpu::Optical> optical, std::span<const float> eta,
                       std::span<const SurfaceSample> samples, std::span<const gpu::Optical> elsewhere) {
  check_optical(optical, rest_[number].node_count());
  if (!elsewhere.empty()) check_optical(elsewhere, points_of_a_tet * rest_[number].tet_count());
  refractions_.set(eta);
  if (material_) std::fill(albedo_.begin(), albedo_.end(), std::nullopt);
  material_.reset();
  angles_ = {};
  device::rewrite(device_, optical, "material/level " + std::to_string(number) + " given", given_[number]);
  changed();
  albedo_[number] = least_albedo(optical);
  if (number == 0) given_elsewhere_.assign(elsewhere.begin(), elsewhere.end());
  if (number == 0) rounding_ = quadgraph::packed_rounding(optical, spacing(0));
  sampled_[number].clear();
  for (const SurfaceSample& sample : samples) sampled_[number].push_back(optical[sample.tet]);
}

void Coefficients::set(std::span<const Edit> edits) {
  for (std::size_t i = 0; i < edits.size(); ++i) {
    try {
      check_edit(edits[i]);
    } catch (const InputError& error) {
      throw InputError("edit " + std::to_string(i) + ", " + error.what());
    }
  }
  edits_ = EditArrays(edits);
  edit_buffers_.count = static_cast<std::uint32_t>(edits.size());
  device::rewrite<gpu::MaterialEdit>(device_, edits_.edits, "material/edits", edit_buffers_.edits);
  device::rewrite<glm::vec3>(device_, edits_.points, "material/strokes", edit_buffers_.points);
  device::rewrite<glm::vec3>(device_, edits_.texels, "material/images", edit_buffers_.texels);
  changed();
}

const std::vector<float>& Coefficients::depth(std::uint32_t number) {
  if (depth_[number].empty()) depth_[number] = depth_below_surface(rest_[number], rest_[number].nodes);
  return depth_[number];
}

float Coefficients::spacing(std::uint32_t number) {
  if (!spacing_[number]) spacing_[number] = node_spacing(rest_[number]);
  return *spacing_[number];
}

std::vector<gpu::Optical> Coefficients::at(std::uint32_t number, std::span<const SurfaceSample> samples) {
  const bool deep = wants_depth();
  std::vector<gpu::Optical> optical;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::uint32_t tet = samples[i].tet;
    const glm::vec3& place = rest_[number].nodes[tet];
    const float below = deep ? depth(number)[tet] : 0;
    const gpu::Optical base = material_ ? gpu::material_at(*material_, place, below) : sampled_[number][i];
    optical.push_back(edits_.apply(base, place, below, spacing(number)));
  }
  return optical;
}

const std::vector<gpu::Optical>& Coefficients::elsewhere() {
  if (elsewhere_) return *elsewhere_;
  std::vector<gpu::Optical> optical = given_elsewhere_;
  if (even() || (!material_ && optical.empty())) return elsewhere_.emplace(std::move(optical));
  const std::vector<glm::vec3> places = points_in_tets(rest_[0], [&] { device_.heed(); });
  const bool deep = wants_depth();
  if (deep && depth_elsewhere_.empty()) depth_elsewhere_ = depth_below_surface(rest_[0], places);
  optical.resize(places.size());
  for (std::size_t t = 0; t < places.size(); ++t) {
    if (t % 256 == 0) device_.heed();  // a pattern's noise takes a microsecond or more
    const float below = deep ? depth_elsewhere_[t] : 0;
    const gpu::Optical base = material_ ? gpu::material_at(*material_, places[t], below) : optical[t];
    optical[t] = edits_.apply(base, places[t], below, spacing(0));
  }
  return elsewhere_.emplace(std::move(optical));
}

void Coefficients::check() const {
  if (material_) return;
  const auto missing = std::find(albedo_.begin(), albedo_.end(), std::nullopt);
  if (missing == albedo_.end()) return;
  if (std::all_of(albedo_.begin(), albedo_.end(), [](const auto& albedo) { return !albedo; })) {
    throw InputError("no material has been set");
  }
  throw InputError("optical: set for some levels, but not for level " + std::to_string(missing - albedo_.begin()));
}

Model Coefficients::resolve(Workspace& work, Model wanted, Method method, Source source,
                            std::vector<LevelBuffers>& levels) {
  double least = 1;
  for (const auto& albedo : albedo_) least = std::min(least, *albedo);
  if (!edits_.edits.empty()) {
    if (!edited_) {
      make_room(method, levels);
      record(work, levels);
      edited_ = measured(work, levels[0]);
    }
    least = edited_->albedo;
  }
  Model model = Model::diffusion;
  for (const float eta : refractions_.eta()) {
    model = std::max(model, resolve_model(wanted, method, source, least, static_cast<double>(eta)));
  }
  return model;
}

double Coefficients::packed_rounding(Model model) const {
  const glm::vec2& rounding = edited_ ? edited_->rounding : rounding_;
  return static_cast<double>(model == Model::sp3 ? rounding.y : rounding.x);
}

Coefficients::Range Coefficients::measured(Workspace& work, const LevelBuffers& level) {
  constexpr std::uint32_t one = std::bit_cast<std::uint32_t>(1.0f);
  if (!measured_.exists()) {
    measured_ = {device_, 3 * sizeof(float), device::Place::device, "material/range"};
    measured_on_host_ = {device_, 3 * sizeof(float), device::Place::host, "material/range on the host"};
  }
  const std::uint32_t elements = count(level, extent_);
  work.recorder.fill(measured_, one);
  work.recorder.dispatch(
      work.passes.of(shader::optical_range),
      gpu::OpticalRangePush{
          .optical = level.optical.address(), .range = measured_.address(), .spacing = spacing(0), .count = elements},
      elements, "optical range", std::uint64_t{elements} * sizeof(gpu::Optical));
  work.recorder.copy(measured_, measured_on_host_, 3 * sizeof(float));
  work.recorder.submit();
  const std::span<const float> found = measured_on_host_.mapped_as<float>();
  return {static_cast<double>(found[0]), {found[1], found[2]}};
}

std::uint32_t Coefficients::count(const LevelBuffers& level, Extent extent) {
  return extent == Extent::nodes ? level.node_count : extent == Extent::tets ? level.tet_count : 1;
}

void Coefficients::make_room(Method method, std::vector<LevelBuffers>& levels) {
  extent_ = !on_vertices(method) ? Extent::nodes : even() ? Extent::one : Extent::tets;
  const bool edited = !edits_.edits.empty(), placed = edited || (material_ && !even());
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    LevelBuffers& level = levels[i];
    level.even = even();
    const std::uint32_t wanted = count(level, extent_);
    if (level.optical.size() < wanted * sizeof(gpu::Optical)) {
      level.optical = room(device_, i, wanted);
      evaluated_.reset();
    }
    const std::string name = "material/level " + std::to_string(i);
    if (placed && level.rest.size() < wanted * sizeof(glm::vec3)) {
      level.rest = device::upload(device_, rest_[i].nodes.first(wanted), name + " rest");
    }
    if (wants_depth() && depth_buffers_[i].size() == 0) {
      depth_buffers_[i] = device::upload<float>(device_, depth(i), name + " depth");
    }
  }
}

void Coefficients::record(Workspace& work, const std::vector<LevelBuffers>& levels) {
  if (evaluated_ && *evaluated_ >= extent_) return;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const LevelBuffers& level = levels[i];
    const std::uint32_t wanted = count(level, extent_);
    const device::Buffer* depth = wants_depth() ? &depth_buffers_[i] : nullptr;
    if (material_) record_material(work, level, *material_, depth, wanted);
    if (!material_ || edit_buffers_.count > 0) {
      record_edits(work, level, material_ ? level.optical : given_[i], edit_buffers_, depth,
                   spacing(static_cast<std::uint32_t>(i)), wanted);
    }
  }
  evaluated_ = extent_;
}

}  // namespace quadgraph
