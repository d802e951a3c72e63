// Lights in a scene file.
#pragma once

#include "engine/render/light/lights.h"
#include "engine/scene/json_field.h"

namespace quadgraph {

// An object with the light's type and its other members as docs/scene.md lists them; units and directions as in Light.
// Throws InputError with the path of what is wrong.
Light light_from(const JsonField& field);

Json to_json(const Light& light);

}  // namespace quadgraph
