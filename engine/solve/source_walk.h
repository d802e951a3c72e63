// The buried source on one level: light that enters is followed along refracted rays, and what it scatters there for
// the first time is the source of the solve.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "engine/base/solve_options.h"
#include "engine/solve/beams.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/operator_buffers.h"
#include "engine/solve/workspace.h"
#include "shaders/source/walk_shared.h"

namespace quadgraph {

// Where the power went that the rays did not scatter, W. Together with the deposits it is what entered, to rounding.
struct WalkPower {
  glm::dvec3 absorbed{0};
  glm::dvec3 unscattered{
      0};  // left through the surface, or trapped in a clear region for longer than any ray is followed
};

// Sums in fixed point (walk_shared.h) as numbers, W.
std::vector<glm::dvec3> powers(std::span<const std::uint32_t> words, const glm::dvec3& scale);

// How the light of a level is walked.
struct WalkTask {
  Method method = Method::fem;
  bool even = false;       // the coefficients are the same everywhere
  bool mean_rays = false;  // SolveOptions
  std::uint32_t seed = 0;  // of the rays of a correction
};

// Rays from one origin on a face, of a beam of this kind.
std::uint32_t rays_of(std::uint32_t beam_kind, bool mean_rays);

// Bytes that the walk of so many rays a face moves: every invocation looks at its face; half the faces are lit,
// uniformly, and a ray crosses ten tets, about as many as in marble at the finest level.
std::uint64_t walk_bytes(const LevelBuffers& level, std::uint32_t ray_count);

class SourceWalk {
 public:
  // Throws InputError if the level has too many tets and faces.
  SourceWalk(device::Device& device, const Level& level, std::uint32_t number);

  // The shape has changed.
  void moved() { moved_ = true; }

  // The tets as rays see them, if they are behind the shape.
  void record_cells(Workspace& work, const LevelBuffers& level);

  // What rays need of the level, once its cells are recorded. `even`: level.optical is the same everywhere, which saves
  // its reading.
  gpu::BodyRef body(const LevelBuffers& level, bool even) const;

  // Light, material or shape have changed.
  void invalidate() { walked_ = {false, false}; }

  // Room for what `record` and, with `again`, `record_again` write, unless it is there.
  void make_room(device::Device& device, const LevelBuffers& level, Method method, bool again);

  const device::Buffer& cells() const { return cells_; }  // TetCell per tet

  // Walks, unless that has been done for the present light by the same rays: level.beam_q of every beam of the scene,
  // scaled by work.scale. The graph methods share their deposits.
  void record(Workspace& work, const LevelBuffers& level, const BeamBuffers& beams, const WalkTask& task);

  // The results are without light that entered again, until record_again.
  void forget_again() { again_ = false; }

  // Adds the beam of light that enters again to the deposits of a walk recorded before; every call anew.
  void record_again(Workspace& work, const LevelBuffers& level, const BeamBuffers& beams, const WalkTask& task);

  // b of the solve, and its norm, from the deposits of a walk recorded before.
  void record_right_hand_side(Workspace& work, const LevelBuffers& level, Method method, OperatorBuffers& op) const;

  // Fixed point (walk_shared.h): per vertex (fem) or tet what was scattered, and per face what left.
  const device::Buffer& deposit(Method method) const { return (again_ ? all_deposits_ : deposits_)[carrier(method)]; }
  const device::Buffer& first_deposit() const { return deposits_[0]; }  // of the scene's light, per vertex
  const device::Buffer& unscattered() const { return again_ ? all_unscattered_ : unscattered_; }

  // W per face of what left unscattered, in the last walk that has run; `scale` as on the device.
  std::vector<glm::dvec3> unscattered_power(device::Device& device, const glm::dvec3& scale) const;

  // Power of the last walk that has run.
  WalkPower power() const;
  // Tets that its rays crossed.
  double segments() const;

 private:
  // Fixed point, by workgroup absorbed and unscattered; and the tets crossed.
  struct Sums {
    device::Buffer sums, sums_on_host, scale_on_host;

    void make_room(device::Device& device, const std::string& prefix);
    void read_back(Workspace& work) const;
    WalkPower power() const;
    double segments() const;
  };

  static std::size_t carrier(Method method) { return on_vertices(method) ? 0 : 1; }

  gpu::WalkSourcePush push(Workspace& work, const LevelBuffers& level, const BeamBuffers& beams, const WalkTask& task);

  std::string prefix_;
  std::array<bool, 2> walked_ = {false, false};  // by carrier
  bool mean_rays_ = false;                       // in what was walked
  bool again_ = false;                           // light that entered again is in the results
  device::Buffer cells_, body_on_device_;
  gpu::BodyRef body_{};  // as on the device
  bool moved_ = true;    // cells_ has another shape
  // Results for the scene's light; by carrier, made at first use.
  std::array<device::Buffer, 2> deposits_;
  device::Buffer unscattered_;
  Sums sums_;
  // Results with the light that entered again; made at first use.
  std::array<device::Buffer, 2> all_deposits_;
  device::Buffer all_unscattered_;
  Sums sums_again_;
};

}  // namespace quadgraph
