// Files of normal maps.
#pragma once

#include <filesystem>
#include <memory>

#include "engine/base/image.h"

namespace quadgraph {

// A picture of normals, 0 to 1, as slopes.
Image slopes_from(Image normals);

// The slopes (engine/render/display/normal_map.h) of a normal map in tangent space: red to the right, green to the top,
// blue out of the surface, each from -1 to 1 (glTF 2.0, 3.9.3: green of OpenGL), in a .png whose values are taken as
// they stand, 8 bits of them. From memory if the file has not changed since it was read. Texels that point into the
// surface lean nowhere. Throws InputError as read_image, and where more than half of the texels do.
std::shared_ptr<const ImagePyramid> load_normal_map(const std::filesystem::path& path);

}  // namespace quadgraph
