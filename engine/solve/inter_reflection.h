// Inter-reflection between points of the surface: light that leaves the body and meets it again enters it again, bounce
// by bounce, on the level whose file says what its faces see of each other (Level::seen).
//
// One bounce: E_f = 1/N sum over entries of J, J = M + (1 - T_d) E, scaled by one factor per channel so that all that
// is sent towards the body arrives. T_d E enters, as one beam (BeamBuffers) along one ray per face. Finer levels get E
// by the surface transfers, with the same power; coarser ones have none.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/solve/exchange_matrix.h"
#include "engine/solve/sky_levels.h"
#include "engine/solve/surface_results.h"

namespace quadgraph {

class InterReflection {
 public:
  // `graph` must stay alive. Buffers are made at first use.
  explicit InterReflection(const QuadGraph& graph);

  // Whether the file says what the faces of some level see.
  bool baked() const { return matrix_.has_value(); }

  // Room for the bounces, unless it is there. To be called where `level` has a value.
  void make_room(Workspace& work, const std::vector<LevelBuffers>& levels);

  // The level on which faces see each other, if any do; no light enters again elsewhere.
  std::optional<std::uint32_t> level() const { return matrix_ && !matrix_->empty() ? level_ : std::nullopt; }

  // Rows and entries of that level: what its faces see.
  std::optional<SeenRows> seen(device::Device& device);

  // The vertices of level `number` have moved.
  void moved(std::uint32_t number);

  // The areas of faces that `refresh` is given are others.
  void remeasure() { sky_.reset(); }

  // The body has turned or moved as a whole.
  void turned();

  // The shape is that of the file again, and so is what its faces see.
  void put_back(device::Device& device, std::vector<LevelBuffers>& levels);

  // Brings up to `rows` rows that are behind the shape up to date, all with 0; then the view of the sky on every level.
  // To be called once in a solve. Whether there were any.
  bool refresh(Workspace& work, std::span<const Level> shape, std::vector<LevelBuffers>& levels, std::uint32_t rows);

  // How far the exchange is behind the shape, as ExchangeMatrix::age; 0 without one.
  std::uint32_t age() const { return matrix_ ? matrix_->age() : 0; }

  // Work was given up half-way: what entered again is not known until record_none, which may have been recorded and not
  // done.
  void start_over();

  // No light has entered again, on any level.
  void record_none(Workspace& work, const std::vector<LevelBuffers>& levels);

  // One bounce, from M of `solved` on the level with the exchange, and from what entered again so far.
  void record_bounce(Workspace& work, const Solved& solved);

  // The beam of level `number`: on the level with the exchange what entered again so far; on finer ones the same, from
  // the next coarser level, whose beam comes first.
  void record_beam(Workspace& work, const std::vector<LevelBuffers>& levels, std::uint32_t number);

  // Whether light may have entered again since record_none.
  bool any() const { return any_; }

  // From here on bounces count as those of a new solve.
  void begin();
  std::uint32_t count() const { return count_; }

  // The last bounce that has run: its power, 0 without any, and whether it was small enough to be the last.
  glm::dvec3 power() const;  // W, that enters again
  bool converged(double tolerance) const;

  // W, what every bounce since `begin` brought in.
  std::vector<glm::dvec3> bounces() const;

 private:
  struct Finer {
    device::Buffer index, weight;
    std::uint32_t width = 0;
  };

  void record_enter(Workspace& work, const LevelBuffers& level, const device::Buffer& irradiance);

  const QuadGraph& graph_;
  std::optional<std::uint32_t> level_;
  std::optional<ExchangeMatrix> matrix_;
  std::optional<SkyLevels> sky_;          // made at first use
  bool any_ = false;                      // some beam may not be zero
  device::Buffer phi_, exitance_, clip_;  // exitance.comp
  std::vector<device::Buffer>
      irradiance_;                 // vec3 per face, W/mm^2; finest level first, the last that with the exchange
  device::Buffer before_;          // that of the bounce before
  std::vector<Finer> finer_;       // transfers, finest first
  device::Buffer factor_;          // vec3
  device::Buffer state_;           // ExchangeState
  device::Buffer states_on_host_;  // of every bounce of a solve, mapped
  std::uint32_t count_ = 0;        // of bounces in this solve
  glm::dvec3 begun_with_{0};       // W, before them
};

}  // namespace quadgraph
