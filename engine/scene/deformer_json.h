// Deformers in a scene file.
#pragma once

#include "engine/deform/deformer.h"
#include "engine/scene/json_field.h"

namespace quadgraph {

// {"type": "twist", "axis": [0, 1, 0], "degrees": 90, "range": [0, 1]}: the members of Deformer that its kind uses;
// "range" in shares of the rest box or "range_mm" in coordinates along the axis; "shapes" the file that has them.
// Throws InputError with the path of what is wrong.
Deformer deformer_from(const JsonField& field);

// Throws InputError for shapes that are in no file.
Json to_json(const Deformer& deformer);

}  // namespace quadgraph
