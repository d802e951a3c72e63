// Where the coefficients at the nodes of all levels come from: a material or arrays, and edits of these.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/base/solve_options.h"
#include "engine/optics/edit.h"
#include "engine/optics/material.h"
#include "engine/reference/resolution.h"
#include "engine/solve/assembly.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/refractions.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

class Coefficients {
 public:
  // `rest`, the levels of the file, and `refractions`, which get the indices that come with coefficients, must stay
  // alive.
  Coefficients(device::Device& device, std::span<const Level> rest, Refractions& refractions);

  // Throws InputError as check_material does.
  void set(const gpu::Material& material);

  // Takes the coefficients of level `number`, and notes those at `samples`. `elsewhere`: those of the finest level at
  // points_in_tets; none where they are not known. eta: as Refractions::set. Throws InputError on a wrong size or
  // value.
  void set(std::uint32_t number, std::span<const gpu::Optical> optical, std::span<const float> eta,
           std::span<const SurfaceSample> samples, std::span<const gpu::Optical> elsewhere);

  // Edits of the material or the arrays, also of those that are set later. Throws InputError naming the edit and as
  // check_edit.
  void set(std::span<const Edit> edits);

  // Throws InputError if there are none, or not for every level.
  void check() const;

  // By which angles light scatters, until the next coefficients are set.
  void set(const ScatteringAngles& angles) { angles_ = angles; }
  const ScatteringAngles& angles() const { return angles_; }

  // Whether the coefficients are the same everywhere.
  bool even() const { return material_ && material_->pattern == gpu::PATTERN_NONE && edits_.edits.empty(); }

  // One entry per sample of level `number`.
  std::vector<gpu::Optical> at(std::uint32_t number, std::span<const SurfaceSample> samples);

  // Of the finest level, at points_in_tets; none where they are even, or not known there.
  const std::vector<gpu::Optical>& elsewhere();

  // Buffers may hold anything: they are evaluated again.
  void forget() { changed(); }

  // The model that is meant where `wanted` is automatic. Edited coefficients are evaluated for that.
  Model resolve(Workspace& work, Model wanted, Method method, Source source, std::vector<LevelBuffers>& levels);

  // gpu::packed_rounding of a model, the largest of the finest level, once `resolve` was called.
  double packed_rounding(Model model) const;

  // Room in `levels` for the coefficients that a method needs, and what they are evaluated at. To be called before a
  // solve.
  void make_room(Method method, std::vector<LevelBuffers>& levels);

  // Evaluates the coefficients on all levels, unless that has been done.
  void record(Workspace& work, const std::vector<LevelBuffers>& levels);

 private:
  // Of coefficients of the finest level: the least albedo, and gpu::packed_rounding on its elements.
  struct Range {
    double albedo = 1;
    glm::vec2 rounding{1};
  };

  // Where coefficients are wanted: linear elements take those of the tets, and where these are all the same, of one.
  enum class Extent { one, tets, nodes };

  static std::uint32_t count(const LevelBuffers& level, Extent extent);

  void changed();
  Range measured(Workspace& work, const LevelBuffers& level);
  bool layered() const { return material_ && material_->pattern == gpu::PATTERN_LAYERS; }
  bool wants_depth() const { return layered() || edits_.wants_depth(); }
  const std::vector<float>& depth(std::uint32_t number);
  float spacing(std::uint32_t number);

  device::Device& device_;
  Refractions& refractions_;
  std::span<const Level> rest_;
  std::optional<gpu::Material> material_;
  ScatteringAngles angles_;
  std::vector<device::Buffer> given_;  // arrays, per level, where there is no material
  EditArrays edits_{{}};
  EditBuffers edit_buffers_;
  std::vector<std::vector<float>> depth_;  // mm, of the nodes of every level, computed at first use
  std::vector<device::Buffer> depth_buffers_;
  std::vector<std::optional<float>> spacing_;  // mm, of the nodes of every level, computed at first use
  Extent extent_ = Extent::one;
  std::optional<Extent> evaluated_;             // the present coefficients, there
  std::vector<std::optional<double>> albedo_;   // the least one of every level, before edits
  glm::vec2 rounding_{1};                       // gpu::packed_rounding of the finest one, before edits
  device::Buffer measured_, measured_on_host_;  // of edited coefficients
  std::optional<Range> edited_;                 // after edits
  std::vector<gpu::Optical> given_elsewhere_;   // of the finest level, with `given_`
  std::optional<std::vector<gpu::Optical>> elsewhere_;
  std::vector<float> depth_elsewhere_;              // mm, computed at first use
  std::vector<std::vector<gpu::Optical>> sampled_;  // of every level whose coefficients were given
};

}  // namespace quadgraph
