// Edits of the material in a scene file, and their layers.
#pragma once

#include "engine/optics/edit_layer.h"
#include "engine/scene/json_field.h"

namespace quadgraph {

// {"operation": "multiply", "sigma_a": 2, "stroke": [[x, y, z], ...], "radius": 4, "depth": [0, 3], "softness": 1,
// "placement": {...}, "image": FILE, "mask": FILE, "mirrored": {"stroke": [...], "placement": {...}}}:
// the members of Edit; "operation" multiply, add or set; coefficients one number or three; without "depth" all of it.
// Throws InputError with the path of what is wrong.
Edit edit_from(const JsonField& field);

Json to_json(const Edit& edit);

// An array of edits and of layers, {"name": "Veins", "visible": true, "opacity": 1, "edits": [...]}: edits without a
// layer, one after the other, are one of the name that layer_name gives. Throws InputError with the path of what is
// wrong.
std::vector<EditLayer> layers_from(const JsonField& field);

// What layers_from reads: one layer that is as if its edits had none is these edits, unless it is empty.
Json layers_json(const std::vector<EditLayer>& layers);

}  // namespace quadgraph
