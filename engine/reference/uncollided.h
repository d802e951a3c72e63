// Light that has not scattered, as fields at the vertices, on the CPU in double precision. The GPU does the same in
// shaders/gather/uncollided.comp.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/reference/operator.h"
#include "engine/reference/source_walk.h"
#include "engine/reference/vertex_starts.h"

namespace quadgraph {

// Per vertex. Fluence of uncollided light is entry exp(-depth); both factors are linear between vertices, which is
// exact for a beam behind a flat face.
struct Uncollided {
  std::vector<glm::dvec3> entry;  // W/mm^2, >= 0: what the fluence would be without attenuation
  std::vector<glm::dvec3> depth;  // optical depth, >= 0
};

// One beam and what of it the surface lets in, one entry per outside face.
struct BeamLight {
  gpu::BeamRecord beam{};
  std::span<const Quarters> quarters;
};

// Followed back from every vertex against the light, mirrored at reflecting faces; for eta > 1 straight first, to learn
// the normal that refracts it. Where several beams meet, entries and fluences add up. Internal reflections of
// uncollided light are left out. `problem` must be valid.
Uncollided uncollided(const Level& level, const Problem& problem, std::span<const BeamLight> beams,
                      const VertexStarts& starts);

}  // namespace quadgraph
