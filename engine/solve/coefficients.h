// Where the coefficients at the nodes of all levels come from: a material, or arrays.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/graph/resolution.h"
#include "engine/graph/solution.h"
#include "engine/solve/simulation.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

class Coefficients {
 public:
  explicit Coefficients(std::size_t levels) : albedo_(levels), sampled_(levels) {}

  // Throws InputError as check_material does.
  void set(const gpu::Material& material);

  // Takes the coefficients of level `number`, and notes those at `samples`. Throws InputError on a wrong size or value.
  void set(vk::Context& context, std::uint32_t number, std::span<const gpu::Optical> optical, float eta,
           LevelBuffers& level, std::span<const SurfaceSample> samples);

  // Throws InputError if there are none, or not for every level.
  void check() const;

  float eta() const { return eta_; }

  // The same everywhere.
  bool even() const { return material_ && material_->pattern == gpu::PATTERN_NONE; }

  // One entry per sample of level `number`, which is `rest` in the file.
  std::vector<gpu::Optical> at(std::uint32_t number, const Level& rest, std::span<const SurfaceSample> samples) const;

  // The model that is meant where `wanted` is automatic.
  Model resolve(Model wanted, Method method, Source source) const;

  // Room in `levels` for the coefficients that a method needs, and what they are evaluated at. `rest` are the levels of
  // the file. To be called before a solve.
  void make_room(vk::Context& context, std::span<const Level> rest, Method method, std::vector<LevelBuffers>& levels);

  // Evaluates the material on all levels, unless that has been done.
  void record(Workspace& work, const std::vector<LevelBuffers>& levels);

 private:
  // Where coefficients are wanted: linear elements take those of the tets, and where these are all the same, of one.
  enum class Extent { one, tets, nodes };

  static std::uint32_t count(const LevelBuffers& level, Extent extent);

  std::optional<gpu::Material> material_;
  Extent extent_ = Extent::one;
  std::optional<Extent> evaluated_;  // material_, there
  float eta_ = 1;
  std::vector<std::optional<double>> albedo_;       // the least one of every level
  std::vector<std::vector<gpu::Optical>> sampled_;  // of every level whose coefficients were given
};

}  // namespace quadgraph
