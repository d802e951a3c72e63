// Mean value coordinates of a point in a closed triangle mesh (Ju, Schaefer and Warren 2005).
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace quadgraph {

// One weight per vertex of the mesh, of sum 1, with sum w_k p_k = point. Positive inside a convex mesh. On a vertex the
// weight is that vertex's, on a triangle those of its corners; outside the mesh they go on smoothly but for places
// where they have no value, where the nearest vertex has all the weight.
std::vector<double> mean_value_weights(std::span<const glm::dvec3> vertices, std::span<const glm::uvec3> triangles,
                                       const glm::dvec3& point);

}  // namespace quadgraph
