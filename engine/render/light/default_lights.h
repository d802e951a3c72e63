// The light a picture gets when nobody asks for another.
#pragma once

#include <vector>

#include "engine/render/display/camera.h"
#include "engine/render/light/lights.h"

namespace quadgraph {

// Seen from `view`: a warm key light from behind, above and to the left, that shines through thin parts, and a
// cool one from the right side, somewhat to the front, a fifth as strong; and a fiftieth from all around, so that no
// part is black.
std::vector<Light> default_lights(const View& view);

// The studio that is built in (engine/render/light/studio.h), turned so that its warm box stands behind the object.
Light studio_of(const View& view);

}  // namespace quadgraph
