// What sweeps know of light that scatters forwards: delta-Eddington, by which light goes to one side, too
// (docs/physics.md, "Transport correction"). Of the finest level.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "engine/file/graph.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/source_walk.h"
#include "engine/solve/workspace.h"
#include "shaders/transport/transport_shared.h"

namespace quadgraph {

// Of the present solve.
struct ForwardParts {
  Workspace& work;
  const LevelBuffers& level;
  const device::Buffer& deposit;                     // as of TransportForwardRef
  const device::Buffer &tet_offset, &tet_incidence;  // tets around each vertex
  const device::Buffer& unit;                        // vec3: the scale of what was known
};

// g: mean cosine of the angle by which light scatters, above -1 and below 1.
gpu::BesidePeak beside_peak_of(const glm::vec3& g);

class ForwardScattering {
 public:
  // `level`: the finest, whose tets stay what they are.
  ForwardScattering(device::Device& device, const Level& level);

  // What a solve begins with, before its light is walked. g: mean cosine of the angle by which light scatters.
  void record_start(const ForwardParts& parts, const glm::vec3& g);

  // Adds to the fluence (vec3 per vertex, scaled) so much of what the solve has as unscattered and the walk has not.
  // mass: of transport_mass.comp.
  void record_sooner(const ForwardParts& parts, const SourceWalk& walk, const device::Buffer& mass,
                     const device::Buffer& fluence, float share);

  // The flux that belongs to a fluence; with what sweeps have added before, if that is kept.
  void record_flux(const ForwardParts& parts, const device::Buffer& fluence, bool keep);

  // What samples see: a share of the present field, less one of that before.
  void record_flow(const ForwardParts& parts, float share, float keep);

  // Forgets what samples found.
  void record_nothing_found(const ForwardParts& parts);

  // What they found of the flux, of which `share` counts, and of that before `keep`, as `load`, three vec3 per vertex.
  void record_load(const ForwardParts& parts, float share, float keep);

  // Adds to the flux what a sweep has changed of it (`swept`), and what follows from the changes of both halves; gain:
  // address of the factor that these have; adds: as of TransportShares.
  void record_step(const ForwardParts& parts, const std::array<device::Buffer, 2>& change, std::uint64_t gain,
                   bool adds);

  const gpu::BesidePeak& beside() const { return beside_; }   // of the last start
  const device::Buffer& ref() const { return ref_; }          // TransportForwardRef
  const device::Buffer& optical() const { return optical_; }  // gpu::Optical per tet, or one: as rays see them
  const device::Buffer& towards() const { return towards_; }  // fixed point, three per tet
  const device::Buffer& leaving() const { return leaving_; }  // fixed point, per face: power that leaves unscattered
  const device::Buffer& flux() const { return flux_; }        // three vec3 per vertex, scaled
  const device::Buffer& flux_seen() const { return flux_seen_; }
  const device::Buffer& flows() const { return flows_; }  // as of TransportFieldRef
  const device::Buffer& found() const { return found_; }  // fixed point, as of TransportFluxLoadPush
  const device::Buffer& load() const { return load_; }    // three vec3 per vertex
  const device::Buffer& swept() const { return swept_; }  // the same

 private:
  void write_ref(const ForwardParts& parts);
  struct FluxTask {  // as TransportFluxPush says
    std::uint64_t a, b, gain = 0, swept = 0;
    float keep = 0, adds = 0;
  };
  void record_flux_of(const ForwardParts& parts, const FluxTask& task);

  gpu::BesidePeak beside_{};
  device::Buffer ref_, optical_, towards_, leaving_;
  device::Buffer flux_, flux_before_, flux_seen_, flux_added_;
  device::Buffer flows_, flows_before_;
  device::Buffer found_, load_, swept_;
};

}  // namespace quadgraph
