// The light a picture gets when nobody asks for another.
#pragma once

#include <vector>

#include "engine/render/camera.h"
#include "engine/render/lights.h"

namespace quadgraph {

// Seen from `view`: a key light from behind, above and to the left, that shines through thin parts, and a third as
// strong a fill from the right side, slightly to the front.
std::vector<Light> default_lights(const View& view);

}  // namespace quadgraph
