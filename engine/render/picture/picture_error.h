// What the scattered light of a picture is off by.
//
// Each pixel has the error of the exitance of the part of the surface that it shows. What leaves in a direction is
// known less well than what leaves in all of them: of what view rays make of the angle, the difference from a diffuser
// with the same exitance, a share `angle_share` is counted as wrong. Where the material changes within tets, the view
// rays of a block of pixels gather once more with the material of other places in the tets: where these are larger than
// the block, the picture is off by as much as it changes by.
#pragma once

#include <optional>

#include "engine/device/memory.h"
#include "engine/reference/error_estimate.h"
#include "engine/render/picture/picture_buffers.h"

namespace quadgraph {

// Measured on the seeds 61 to 80 of `quadgraph accuracy pictures`, and judged on others (docs/accuracy.md, "Pictures of
// unseen bodies").
constexpr double angle_share = 0.08;

// Relative RMS over pixels, channels together: of all that show the body, of what shows its unlit part, and of the
// third that is dimmest. exitance: of the solve that the picture shows. Empty where the picture does not tell
// (has_doubt).
std::optional<ErrorEstimate> picture_error(device::Device& device, const PictureBuffers& picture,
                                           const ErrorEstimate& exitance);

// Of that, the part of a material that changes within tets, of all pixels that show the body; 0 where nothing is known.
double medium_of_picture(device::Device& device, const PictureBuffers& picture);

}  // namespace quadgraph
