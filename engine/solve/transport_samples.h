// What rays of the transport correction see, and what they find: the light that scatters for the first time, the
// fluence on its way to transport's, points that sample what that leaves, and the exitance gathered by the faces.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/solve/beams.h"
#include "engine/solve/body_tree.h"
#include "engine/solve/forward_scattering.h"
#include "engine/solve/source_walk.h"
#include "engine/solve/surface_results.h"
#include "engine/solve/workspace.h"
#include "shaders/transport/transport_shared.h"

namespace quadgraph {

// What a correction works with, on the finest level.
struct TransportParts {
  Workspace& work;
  const LevelBuffers& level;
  const BeamBuffers& beams;
  const SourceWalk& walk;
  const device::Buffer& nearest;  // surface vertex of each vertex (engine/reference/vertex_starts.h)
  BodyTree& tree;
  bool outside = false;  // light that leaves may enter again elsewhere
  glm::vec3 g{0};        // mean cosine of the angle by which light scatters

  bool forward() const { return g != glm::vec3(0); }
};

// What samples see is a share of the present field, less one of the field before; what they find is added to a share of
// what was known.
struct TransportShares {
  float present = 1, before = 0, known = 0;
  bool apart = false;  // the field before is seen by itself, in the coefficients that it had
  bool ahead = false;  // the present field has what sweeps have added before
  bool adds = true;    // what this one changes counts among that
};

// What its rays found of light that scatters for the first time.
struct FirstScattered {
  const device::Buffer& deposit;  // fixed point, at the corners of the tets, four each: power, scaled
  const device::Buffer& mass;     // vec3 per vertex, mm^2: integral of sigma_s' times its basis
  const device::Buffer &tet_offset, &tet_incidence;  // tets around each vertex
};

// Power that the light's own rays brought, W, and of what is gathered the share that enters again.
struct TransportPower {
  glm::dvec3 entered{0}, absorbed{0}, unscattered{0}, entered_again{0}, share_again{0};
};

// Rays a face by which light enters whose directions are known.
std::uint32_t entering_rays(bool mean_rays);

class TransportSamples {
 public:
  // `level`: the finest, whose tets stay what they are.
  TransportSamples(device::Device& device, const Level& level);

  // Room for so many points at a time, unless it is there.
  void make_room(device::Device& device, std::uint32_t points);

  // Room for light that scatters forwards, unless it is there. `level`: as above.
  void make_room_forward(device::Device& device, const Level& level);

  // The field of a solve: walks the light, takes the fluence of `op`, weighs the tets. With `shares.ahead` it has what
  // sweeps added to the solution before; with `shares.apart` samples will see the field before by itself.
  void record_start(const TransportParts& parts, const WalkTask& task, const OperatorBuffers& op,
                    const TransportShares& shares);

  // The exitance that is known, for vertices that have moved since; before `record_source`.
  void record_carried(const TransportParts& parts, const BodyBoundaries& boundaries);

  // What samples see from here on; the field before is that of the last call.
  void record_source(const TransportParts& parts, const TransportShares& shares);

  // Exitance of what is seen, by so many rays per face and half, added to a share of what was known, and how much of it
  // enters again.
  void record_exitance(const TransportParts& parts, std::uint32_t rays, float known);

  // Forgets the load; then one draw of points after the other is added to it, with so many rays each, or a share of
  // one.
  void record_no_load(const TransportParts& parts);
  void record_draw(const TransportParts& parts, std::uint32_t directions, double share);

  // Segments so far, to be read after the next submission.
  void record_segments(const TransportParts& parts);

  // To be read by `segments`, `power` and `returns` after the next submission.
  void record_state(const TransportParts& parts);
  double segments() const;
  double returns() const;  // share of what is gathered that enters again, the largest of any channel
  TransportPower power(const glm::dvec3& scale) const;

  std::uint32_t points() const { return points_wanted_; }  // of a draw, about
  // Draws from here on are those of a seed.
  void begin_seeds(std::uint32_t seed);

  // A step of the fluence: what both halves of a load say of it, over the mass and smoothed, and the mean of two
  // changes; of the flux too, where draws of which so much counts have found it.
  void record_step(const TransportParts& parts, const std::array<device::Buffer, 2>& load,
                   const std::array<device::Buffer, 2>& change, const TransportShares& shares, float share);

  // Takes so much of what all steps have changed of the fluence of `op`.
  void record_taken(const TransportParts& parts, const OperatorBuffers& op, double share);

  // What the points of either half are missing, after draws of which so much counts; `known` is the share of what they
  // found before.
  void record_books(const TransportParts& parts, float share, float known);
  const device::Buffer& books() const { return books_; }  // TransportBook
  const device::Buffer& mass() const { return mass_; }    // vec3 per vertex, mm^2: integral of sigma_s' times its basis

  const device::Buffer& field() const { return field_; }  // TransportFieldRef, of the last start

  const ForwardScattering& forward() const { return *forward_; }  // of a start with it

  FirstScattered first() const { return {deposit_, mass_, tet_offset_, tet_incidence_}; }

  const device::Buffer& fluence() const { return fluence_; }    // vec3 per vertex, scaled; to be corrected
  const device::Buffer& load() const { return load_; }          // fixed point, per vertex two per half
  const device::Buffer& gathered() const { return gathered_; }  // vec3 per half and face, scaled
  const device::Buffer& unit() const { return unit_; }          // vec3: the scale of what was known

 private:
  // Tets that a ray crosses, and what it reads in one, and of light that scatters forwards besides; for the bytes.
  static constexpr std::uint64_t tets_per_ray = 10;
  static constexpr std::uint64_t segment_bytes = sizeof(gpu::TetCell) + sizeof(gpu::TetSource) + sizeof(gpu::Optical);
  static constexpr std::uint64_t flow_bytes = gpu::FLOWS * sizeof(glm::vec3);

  // Of each tet at most one point more than it weighs is drawn: ten standard deviations of their number are left.
  static std::uint32_t room_for(std::uint32_t points) { return points + points / 8 + 1024; }

  void write_field(const TransportParts& parts, const WalkTask& task, bool apart);
  void make_room_apart(const TransportParts& parts);
  void record_walk(const TransportParts& parts, const WalkTask& task);
  void record_weights(const TransportParts& parts);
  struct FluenceShares {  // as TransportFluencePush says
    float keep, taken;
    std::uint32_t swept;
  };
  void record_fluence(const TransportParts& parts, const OperatorBuffers& op, const FluenceShares& shares);
  void record_mass(const TransportParts& parts);
  void record_smooth(const TransportParts& parts, std::uint64_t mass, std::uint64_t from, std::uint64_t to);
  void record_flux_step(const TransportParts& parts, const std::array<device::Buffer, 2>& change,
                        const TransportShares& shares, float share);
  ForwardParts forward_parts(const TransportParts& parts) const {
    return {parts.work, parts.level, deposit_, tet_offset_, tet_incidence_, unit_};
  }
  // As rays see them.
  const device::Buffer& optical(const TransportParts& parts) const {
    return parts.forward() ? forward_->optical() : parts.level.optical;
  }
  void record_totals(const TransportParts& parts);
  glm::dvec3 share_again() const;
  void record_optical(const TransportParts& parts);
  void record_sweep(const TransportParts& parts, std::uint32_t directions, std::uint32_t wanted);

  std::uint32_t points_wanted_ = 0, room_ = 0;
  std::uint32_t seed_ = 0;  // of what was recorded last
  std::uint32_t draw_ = 0;  // number of the next draw of points
  device::Buffer field_;    // TransportFieldRef
  device::Buffer sources_;  // TetSource per tet
  device::Buffer deposit_;  // fixed point, four per tet: power scattered for the first time
  device::Buffer fluence_, fluence_before_, fluence_seen_;  // vec3 per vertex, scaled
  device::Buffer added_;                                    // the same, by sweeps so far
  device::Buffer source_before_, unit_;                     // vec3, four per tet; vec3
  device::Buffer fluence_apart_, source_apart_;             // vec3; made at first use
  device::Buffer optical_before_;                           // gpu::Optical per tet, or one
  bool even_before_ = false;                                // there is one
  device::Buffer weights_, total_;                          // vec2 per tet; float
  device::Buffer boundary_;        // nearest_boundary of each vertex; empty where no bodies share a surface
  device::Buffer drawn_, points_;  // uint; TransportPoint
  device::Buffer load_, gathered_;
  device::Buffer tet_offset_, tet_incidence_, mass_;  // tets around each vertex
  device::Buffer point_sums_, books_;
  std::array<device::Buffer, 2> swept_;       // vec3 per vertex
  std::optional<ForwardScattering> forward_;  // made at first use
  device::Buffer segments_, walk_sums_, gather_sums_, segments_on_host_, walk_sums_on_host_, books_on_host_;
};

}  // namespace quadgraph
