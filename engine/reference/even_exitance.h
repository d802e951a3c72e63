// The exitance of a surface that is coarse for its material made even, in double precision;
// shaders/surface/even_exitance.comp is its twin.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/reference/operator.h"

namespace quadgraph {

// Where edges are long against the mean free path linear elements scatter by some percent from vertex to vertex, as
// what their tets keep of a source just below the surface differs. Of `exitance` (W/mm^2 per outside face) what comes
// out near where it went in (`q`, W/mm^2 that enters each face) stays with its face; of the rest any two faces around a
// vertex exchange power, as far as they are lit alike and parted by no crease. The power stays.
void make_even(const Level& level, const Problem& problem, std::span<const glm::dvec3> q,
               std::vector<glm::dvec3>& exitance);

}  // namespace quadgraph
