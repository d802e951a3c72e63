// A surface that leans otherwise than its triangles say.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "engine/base/image.h"
#include "engine/base/range.h"
#include "engine/optics/edit.h"

namespace quadgraph {

inline constexpr Range normal_map_strength_range{.low = 0, .high = 10};

// A picture projected onto the body that says how its surface leans: for what it reflects, for view rays that enter it,
// and for light that does (engine/render/light/leaning.h). Texels hold two slopes, by which the normal leans
// towards the picture's right and its top, and the mean of their squares together
// (engine/render/light/normal_map_file.h).
struct NormalMap {
  std::shared_ptr<const ImagePyramid> slopes{};
  std::optional<Placement> placement{};  // none: all of the body, seen from its front
  float strength = 1;                    // that slopes are multiplied by, in normal_map_strength_range

  bool operator==(const NormalMap&) const = default;

  // By how much all that the picture has makes the square of a roughness larger where it is seen from afar.
  float spread() const;
};

// The box of vertices, mm, seen from an azimuth about y, degrees.
Placement around(std::span<const glm::vec3> vertices, float front);

}  // namespace quadgraph
