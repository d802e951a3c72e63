// Views of the inside: the triangles that show a quantity of the last solve, and what their colours mean.
#pragma once

#include "engine/optics/certainty.h"
#include "engine/render/display/camera.h"
#include "engine/render/inside/false_mesh.h"
#include "engine/render/inside/show.h"
#include "engine/solve/simulation.h"

namespace quadgraph {

struct Inside {
  FalseMesh mesh{};
  Legend legend{};
  Plane plane{0, 0, 1, 0};  // that cuts, turned to the side of the eye
};

struct InsideInput {
  device::Device& device;
  Simulation& simulation;
  const QuadGraph& graph;
  const SolveReport& report;    // of the last solve
  const SolveOptions& options;  // of the same
  const Certainty& certainty;   // of the coefficients, at the vertices of level 0
  const Sphere& bounds;
  glm::vec4 eye{0};  // shaders/shared/eye.h; cuts are open towards it
};

// Not of Quantity::picture. For Quantity::difference the simulation solves with the other method, and then again as it
// did. Throws InputError for a level that there is not, or where the last solve does not know the quantity.
Inside inside_of(const InsideInput& input, const Show& show);

}  // namespace quadgraph
