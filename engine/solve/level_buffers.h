// What lies on the device of every level, for all passes.
#pragma once

#include <cstdint>

#include "engine/device/memory.h"
#include "shaders/solver/solve_shared.h"

namespace quadgraph {

// Geometry and fields of one level on the device. Counts as in Level.
struct LevelBuffers {
  std::uint32_t vertex_count = 0, tet_count = 0, face_count = 0, node_count = 0, surface_vertex_count = 0;
  device::Buffer vertices;   // vec3, mm
  device::Buffer tets;       // uvec4
  device::Buffer faces;      // uvec3
  device::Buffer face_tets;  // uint
  device::Buffer face_kind;  // uint; kinds of the faces (shaders/shared/refraction.h)
  // The open faces at surface vertex v: face_incidence[k], k from face_offset[v] to face_offset[v + 1].
  device::Buffer face_offset, face_incidence;
  device::Buffer links;    // uvec4; for the graph methods, made at first use
  device::Buffer nodes;    // vec3, mm; inner nodes, then surface nodes; for the graph methods, made at first use
  device::Buffer rest;     // nodes where the file has them, as far as optical goes: the material moves with the body
  device::Buffer optical;  // Optical per node; of the tets alone, or one for all (Coefficients), where that is enough
  device::Buffer etendue;  // float per tet (shaders/source/inner_surface.glsl); none: 1 everywhere
  bool even = false;       // optical is the same everywhere, and read from the first
  gpu::LeastTet least{};   // of the tets in the present shape
  bool inverted = false;   // some of them are turned inside out
  device::Buffer q;        // vec3 per face, W/mm^2: written by the lights or by set_irradiance
  device::Buffer beam_q;   // float, per beam (BeamBuffers) gpu::Beam::floats per face: what q is made of
  device::Buffer leaning;  // vec2 per face, where a normal map leans facets (shaders/source/leaning.glsl)
  device::Buffer sky;      // float per face: share of uniform illumination that no other part of the body hides

  // Where the last beam begins in beam_q, that of light that enters again, bytes.
  std::uint64_t beam_again() const { return beam_q.size() - face_count * gpu::BEAM_RGB * sizeof(float); }
};

// What the faces of one level see of each other, on the device: per face the first of its entries and one past the
// last, uvec2; entries, the faces that `rays` cosine-weighted rays met (docs/qgraph-format.md).
struct SeenRows {
  std::uint32_t level;
  const device::Buffer& rows;
  const device::Buffer& entries;
  std::uint32_t rays;
};

}  // namespace quadgraph
