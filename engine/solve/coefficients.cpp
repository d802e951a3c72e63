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

namespace quadgraph {

void Coefficients::set(const gpu::Material& material) {
  check_material(material);
  material_ = material;
  evaluated_ = false;
  eta_ = material.eta;
  std::fill(albedo_.begin(), albedo_.end(), least_albedo(material));
}

void Coefficients::set(vk::Context& context, std::uint32_t number, std::span<const gpu::Optical> optical, float eta,
                       LevelBuffers& level) {
  check_optical(optical, level.node_count);
  check_eta(static_cast<double>(eta));
  if (material_) std::fill(albedo_.begin(), albedo_.end(), std::nullopt);
  material_.reset();
  vk::write_bytes(context, level.optical, std::as_bytes(optical));
  eta_ = eta;
  albedo_[number] = least_albedo(optical);
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

void Coefficients::record(Workspace& work, const std::vector<LevelBuffers>& levels) {
  if (!material_ || evaluated_) return;
  for (const LevelBuffers& level : levels) record_material(work, level, *material_);
  evaluated_ = true;
}

}  // namespace quadgraph
