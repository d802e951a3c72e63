// What speaks against a solve as a whole: numbers that are none, energy that is not conserved, light that does not
// arrive.
#pragma once

#include <span>
#include <string>

#include "engine/file/graph.h"
#include "engine/reference/solution.h"
#include "engine/render/light/lights.h"

namespace quadgraph {

// Whether `point`, mm, is in the body that the outside faces of `level` enclose.
bool is_inside(const Level& level, const glm::vec3& point);

// Adds to `stopped` what is wrong with the answer as it is, and takes back that its last level converged: a value that
// is not finite; more energy unaccounted for than the printed error; no light, although `lights` are on. `inside`: for
// each light whether it stands in the body, where none shines. `light_warning` names those that do.
void judge(SolveReport& report, std::span<const Light> lights, const std::vector<bool>& inside);

}  // namespace quadgraph
