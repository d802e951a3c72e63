// Surroundings that are built in: soft-boxes in a dark room, for pictures that need no sky of a certain place.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "engine/base/image.h"

namespace quadgraph {

// The name that stands for it where an environment's file is said, and for the whole light in the text of one.
inline constexpr std::string_view studio_name = "studio";
inline constexpr std::string_view studio_light = "environment:studio:0:0.0002";

// As engine/render/light/environment.h has such pictures; its brightest texels are about 28.
Image studio_picture();

// The picture of an environment's file: that of the studio by its name, else as read_image.
Image environment_picture(const std::string& file);

// The pyramid of that picture, which is kept, as load_pyramid.
std::shared_ptr<const ImagePyramid> environment_pyramid(const std::string& file);

}  // namespace quadgraph
