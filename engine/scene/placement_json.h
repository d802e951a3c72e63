// Where pictures lie in a body, in a scene file.
#pragma once

#include "engine/optics/edit.h"
#include "engine/scene/json_field.h"

namespace quadgraph {

// {"centre": [x, y, z], "direction": [0, 0, -1], "up": [0, 1, 0], "size": [width, height, depth]}: the members of
// Placement. Throws InputError with the path of what is wrong.
Placement placement_from(const JsonField& field);

Json to_json(const Placement& placement);

// The picture of the file that the field names. Throws InputError with the path and as read_image.
std::shared_ptr<const ImagePyramid> image_from(const JsonField& field);

// What image_from reads. Throws InputError if the picture is of no file.
Json to_json(const ImagePyramid& image);

}  // namespace quadgraph
