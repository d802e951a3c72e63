// From the solve to the transport equation: what a sweep of the transport equation over the solved fluence changes is
// solved for by diffusion, and the exitance is gathered (docs/physics.md, "Transport correction"). What the sweep
// changes says how wrong the solve was. On the finest level.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/solve/correction_error.h"
#include "engine/solve/operators.h"
#include "engine/solve/transport_samples.h"

namespace quadgraph {

// What a correction starts from.
struct CorrectionParts {
  TransportParts transport;
  Operators& operators;                // those of `correction_key` have been created and hold the present coefficients
  const BodyBoundaries& boundaries;    // of that operator
  const Solved& solved;                // fem
  const SurfaceResults& results;       // of the solve
  double slow;                         // as of Resolution
  const std::function<void()>& check;  // called before every draw of points at rest; may throw
};

// The operator of the correction.
inline constexpr OperatorKey correction_key{Method::fem, Model::diffusion};

// Of the extinction sigma_s' + sigma_a at the same places, summed over these and the channels: what changes, as a share
// of it before. 1 where there are other places.
double extinction_change(std::span<const gpu::Optical> before, std::span<const gpu::Optical> now);

// What of that a correction in motion may carry on: what it knows is of the extinction before.
inline constexpr double most_carried = 0.2;

class TransportCorrection {
 public:
  // `level`: the finest, whose tets stay what they are.
  TransportCorrection(device::Device& device, const Level& level);

  // Room for draws of so many points, unless it is there.
  void make_room(device::Device& device, std::uint32_t points) { samples_.make_room(device, points); }

  // The same for light that scatters forwards. `level`: as above.
  void make_room_forward(device::Device& device, const Level& level) { samples_.make_room_forward(device, level); }

  // Sweeps from the solution, so many or until the error is what is wanted; with `options.warm` one of few samples that
  // goes on from what is known. Throws SolverError where a value is not finite, and what `check` throws.
  CorrectionReport run(const CorrectionParts& parts, const SolveOptions& options, const WalkTask& task);

  // Of what was changed of the fluence, from here on, the share that `report` says. To be called once after a run, when
  // the energy has been taken, which is that of all.
  void record_taken(const CorrectionParts& parts, const CorrectionReport& report);

  // The vertices have moved since the last call.
  void moved() { moved_ = true; }

  // The coefficients have.
  void edited() { edited_ = true; }

  // What the last call knows is of no use to the next.
  void forget() { frames_ = 0; }

  // Of the last run: fluence at the vertices (vec3, scaled), what scatters for the first time, and exitance of the
  // faces, W/mm^2.
  const device::Buffer& fluence() const { return samples_.fluence(); }
  FirstScattered first() const { return samples_.first(); }
  const ForwardScattering& forward() const { return samples_.forward(); }  // of a run with it
  const device::Buffer& field() const { return samples_.field(); }         // TransportFieldRef, the body that rays see
  const device::Buffer& exitance() const { return exitance_; }

  // Of the last run at rest, W/mm^2 per face, by each half of the samples alone.
  std::array<std::vector<glm::vec3>, 2> exitance_by_halves(device::Device& device) const;

  // Power of the light's own rays, W; `entered_again` with the scattered light of which `scattered_out` W leave.
  TransportPower power(const glm::dvec3& scale, const glm::dvec3& scattered_out) const;

 private:
  // How a sweep samples: directions per point, rays per face and half, and draws of points, each such a share of what
  // one has at rest, while they add more noise to that of the sweep before than is wanted.
  struct Sampling {
    std::uint32_t directions, face_rays;
    double most_draws;
    ErrorEstimate noise_wanted{}, noise_before{};
    double share = 1;
  };

  void record_load(const CorrectionParts& parts, OperatorBuffers& op, std::uint32_t half, float known);
  void solve(const CorrectionParts& parts, std::uint32_t half, float known);
  void record_change(const CorrectionParts& parts, bool ahead);
  void record_faces(const CorrectionParts& parts);
  void draw(const CorrectionParts& parts, const Sampling& sampling, std::uint32_t draws, const TransportShares& shares);
  CorrectedSweep sweep(const CorrectionParts& parts, const Sampling& sampling, const TransportShares& shares);
  void start(const CorrectionParts& parts, const WalkTask& task, const TransportShares& shares);
  TransportShares shares_in_motion(std::uint32_t frames) const;
  CorrectedSweep sweep_in_motion(const CorrectionParts& parts, const WalkTask& task, const TransportShares& shares);
  void sweep_at_rest(const CorrectionParts& parts, const SolveOptions& options, CorrectionReport& report);

  TransportSamples samples_;
  std::uint32_t draws_ = 0;     // of points, in the load
  std::uint32_t frames_ = 0;    // that what is known is made of; 0: nothing is known
  ErrorEstimate changed_;       // of the last sweep: all that differs from the solve
  ErrorEstimate solves_noise_;  // of the last sweep, without that of the gathered exitance
  double drawn_share_ = 1;      // of the points of a draw, what a frame in motion has
  bool moved_ = false, edited_ = false;
  // vec3 per vertex: b and x of the solve of each half, and b of the sweep before.
  std::array<device::Buffer, 2> right_side_, change_, known_;
  device::Buffer halves_, exitance_;                // vec3 per face, W/mm^2: of each half, and what that makes together
  device::Buffer statistics_, statistics_on_host_;  // two TransportChange
};

}  // namespace quadgraph
