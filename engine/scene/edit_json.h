// Edits of the material in a scene file.
#pragma once

#include "engine/optics/edit.h"
#include "engine/scene/json_field.h"

namespace quadgraph {

// {"operation": "multiply", "sigma_a": 2, "stroke": [[x, y, z], ...], "radius": 4, "depth": [0, 3], "softness": 1,
// "placement": {...}, "image": FILE, "mask": FILE}:
// the members of Edit; "operation" multiply, add or set; coefficients one number or three; without "depth" all of it.
// Throws InputError with the path of what is wrong.
Edit edit_from(const JsonField& field);

Json to_json(const Edit& edit);

}  // namespace quadgraph
