// The bodies that are measured: a level, a material, a light, and what the operator gives for them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/layouts/matrix.h"

namespace quadgraph::layouts {

struct Scene {
  std::vector<gpu::Optical> optical;      // per node
  std::vector<gpu::Optical> at_vertices;  // per vertex
  double eta = 1;
};

// `material` as parse_material, or "checker:CONTRAST": cells of 10 mm of marble, every second one absorbing CONTRAST
// times as much. Throws InputError.
Scene scene_of(const Level& level, const std::string& material);

// A directional light of 1 W/mm^2 from one side, along (-1, -1, -1)/sqrt(3).
struct Light {
  std::vector<glm::vec3> q;  // per outside face, without shadows
  std::vector<Field> b;      // of the buried source
};

Light light_of(const Level& level, const Problem& problem);

// Relative RMS difference of the exitance k11 phi + k12 phi2, over the whole surface and over the faces whose q is
// below a tenth of the mean.
struct ExitanceError {
  double whole = 0, unlit = 0;
};

ExitanceError exitance_error(const Level& level, const Boundary& boundary, const Light& light, std::span<const Field> x,
                             std::span<const Field> exact);

}  // namespace quadgraph::layouts
