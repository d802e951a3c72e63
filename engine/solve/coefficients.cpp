#include "engine/solve/coefficients.h"

#include <algorithm>
#include <string>

#include "engine/graph/error.h"
#include "engine/graph/fresnel.h"
#include "engine/graph/material.h"
#include "engine/graph/model.h"
#include "engine/graph/operator.h"
#include "engine/solve/assembly.h"
#include "engine/vk/commands.h"
#include "shaders/material.h"

namespace quadgraph {

namespace {

vk::Buffer room(vk::Context& context, std::uint32_t number, std::uint64_t count) {
  return {context, count * sizeof(gpu::Optical), vk::Place::fields,
          "material/level " + std::to_string(number) + " optical"};
}

}  // namespace

void Coefficients::set(const gpu::Material& material) {
  check_material(material);
  material_ = material;
  evaluated_.reset();
  eta_ = material.eta;
  std::fill(albedo_.begin(), albedo_.end(), least_albedo(material));
}

void Coefficients::set(vk::Context& context, std::uint32_t number, std::span<const gpu::Optical> optical, float eta,
                       LevelBuffers& level, std::span<const SurfaceSample> samples) {
  check_optical(optical, level.node_count);
  check_eta(static_cast<double>(eta));
  if (material_) std::fill(albedo_.begin(), albedo_.end(), std::nullopt);
  material_.reset();
  if (level.optical.size() < optical.size_bytes()) level.optical = room(context, number, optical.size());
  vk::write_bytes(context, level.optical, std::as_bytes(optical));
  eta_ = eta;
  albedo_[number] = least_albedo(optical);
  sampled_[number].clear();
  for (const SurfaceSample& sample : samples) sampled_[number].push_back(optical[sample.tet]);
}

std::vector<gpu::Optical> Coefficients::at(std::uint32_t number, const Level& rest,
                                           std::span<const SurfaceSample> samples) const {
  if (!material_) return sampled_[number];
  std::vector<gpu::Optical> optical;
  for (const SurfaceSample& sample : samples) {
    optical.push_back(gpu::material_at(*material_, rest.nodes[sample.tet]));
  }
  return optical;
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

Model Coefficients::resolve(Model wanted, Method method, Source source) const {
  double least = 1;
  for (const auto& albedo : albedo_) least = std::min(least, *albedo);
  return resolve_model(wanted, method, source, least, static_cast<double>(eta_));
}

std::uint32_t Coefficients::count(const LevelBuffers& level, Extent extent) {
  return extent == Extent::nodes ? level.node_count : extent == Extent::tets ? level.tet_count : 1;
}

void Coefficients::make_room(vk::Context& context, std::span<const Level> rest, Method method,
                             std::vector<LevelBuffers>& levels) {
  extent_ = method != Method::fem ? Extent::nodes : even() ? Extent::one : Extent::tets;
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    LevelBuffers& level = levels[i];
    level.even = even();
    const std::uint32_t wanted = count(level, extent_);
    if (level.optical.size() < wanted * sizeof(gpu::Optical)) {
      level.optical = room(context, i, wanted);
      evaluated_.reset();
    }
    if (!material_ || even() || level.rest.size() >= wanted * sizeof(glm::vec3)) continue;
    level.rest = vk::upload(context, rest[i].nodes.first(wanted), "material/level " + std::to_string(i) + " rest");
  }
}

void Coefficients::record(Workspace& work, const std::vector<LevelBuffers>& levels) {
  if (!material_ || (evaluated_ && *evaluated_ >= extent_)) return;
  for (const LevelBuffers& level : levels) record_material(work, level, *material_, count(level, extent_));
  evaluated_ = extent_;
}

}  // namespace quadgraph
