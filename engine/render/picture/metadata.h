// What a picture or a report says about how it was made.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "engine/device/device.h"
#include "engine/reference/solution.h"
#include "engine/render/display/camera.h"
#include "engine/render/light/lights.h"
#include "engine/render/picture/picture.h"
#include "shaders/shared/shared.h"

namespace quadgraph {

// `material` as parse_material reads it. Channels that differ are written R/G/B.
std::string material_text(const gpu::Material& material);

struct PictureFacts {
  std::string source;    // file name of the .qgraph
  std::string material;  // as the user named it, or material_text
  std::span<const Light> lights;
  std::string deformation;  // summary_of
  const SolveOptions& options;
  const SolveReport& report;
  std::optional<View> view;
  std::string_view radiance;           // of the picture
  std::optional<ErrorEstimate> error;  // the same
  const device::DeviceInfo& device;
};

Metadata describe(const PictureFacts& facts);

// The metadata and, last, the exposure, the curve and the balance of white.
Metadata with_exposure(Metadata metadata, const Picture& picture, const ToneOptions& options);

}  // namespace quadgraph
