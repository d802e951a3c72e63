// Where a picture is taken from, among the options of a scene.
#pragma once

#include "engine/scene/option_members.h"

namespace quadgraph {

void add_camera_options(OptionTable& table);

}  // namespace quadgraph
