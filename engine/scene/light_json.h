// Lights in a scene file.
#pragma once

#include "engine/render/lights.h"
#include "engine/scene/json_field.h"

namespace quadgraph {

// {"type": "directional", "direction": [x, y, z], "irradiance": E}, {"type": "point", "position": [x, y, z], "power":
// P} or {"type": "ambient", "irradiance": E}; E and P one number or three. Units and directions as in Light. Throws
// InputError with the path of what is wrong.
Light light_from(const JsonField& field);

Json to_json(const Light& light);

}  // namespace quadgraph
