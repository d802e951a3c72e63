// What the operator takes of every tet (engine/reference/elements.h), as a function of the parameters.
#pragma once

#include <vector>

#include "engine/derivative/parameters.h"
#include "engine/reference/elements.h"

namespace quadgraph {

std::vector<ElementCoefficients> elements_of(const Parameters& at);

// The derivative along a direction.
std::vector<ElementCoefficients> elements_along(const Parameters& at, const Parameters& along);

// Adds `factor` times the derivatives of the weighted elements to a gradient.
void add_by_elements(const Parameters& at, const std::vector<ElementCoefficients>& weights, double factor,
                     Parameters& gradient);

}  // namespace quadgraph
