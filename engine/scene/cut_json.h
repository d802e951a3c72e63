// A cut in a scene file.
#pragma once

#include "engine/deform/cut.h"
#include "engine/scene/json_field.h"

namespace quadgraph {

// Throws InputError with the path of what is wrong.
BodyCut cut_from(const JsonField& field);

Json to_json(const BodyCut& cut);

}  // namespace quadgraph
