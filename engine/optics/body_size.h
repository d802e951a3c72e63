// What becomes of a material's look on a body of a size: the same coefficients are clear in a thin body, and have the
// colour of what they absorb in a deep one.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <string_view>

#include "shaders/shared/shared.h"

namespace quadgraph {

// Mean chord that named materials are meant for, mm: that of a bunny of 80 mm, or of a ball of 41 mm.
inline constexpr double meant_chord = 27;

// Share of uniform light from all around that a body sends back of what enters it, by two streams; channels in [0, 1].
// Of a material with a pattern: of its first coefficients. chord: mean chord, mm.
glm::dvec3 body_colour(const gpu::Material& material, double chord);

// What is to be said, in words, of a body on which a material does not look as its text promises: one that begins with
// a name and keeps its coefficients looks as it does at meant_chord, one that says a reflectance has that colour. Empty
// where it looks so, and for texts that promise nothing: other coefficients, or what is no material's text. `material`:
// what parse_material makes of a text that promises something; as quick as a frame wants it, which that is not.
std::string size_warning(std::string_view text, const gpu::Material& material, double chord);

}  // namespace quadgraph
