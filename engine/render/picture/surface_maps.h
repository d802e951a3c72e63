// Pictures that say how a surface is, on the device.
#pragma once

#include <memory>
#include <optional>

#include "engine/device/device.h"
#include "engine/file/graph.h"
#include "engine/render/display/normal_map.h"
#include "engine/render/display/surface_roughness.h"
#include "engine/render/picture/rasteriser.h"

namespace quadgraph {

// Of one body, as what a Rasteriser takes; the last picture of each kind is kept, from its first use on.
class SurfaceMaps {
 public:
  SurfaceMaps(device::Device& device, const QuadGraph& graph) : device_(device), graph_(graph) {}

  PlacedRoughness placed(const RoughnessMap& map);
  PlacedNormals placed(const NormalMap& map);

  // The normal texture of the file, as a map without a placement; none of a file without one.
  const std::optional<NormalMap>& own_normals();

  // Whether a map is that one, by whatever strength: it lies by coordinates of the mesh.
  bool is_own(const NormalMap& map) const { return own_ && map.slopes == own_->slopes; }

 private:
  struct Kept {
    std::shared_ptr<const ImagePyramid> image;
    device::Buffer texels;
  };

  const device::Buffer& at_rest();
  const device::Buffer& texels(Kept& kept, const std::shared_ptr<const ImagePyramid>& image, const char* name);

  device::Device& device_;
  const QuadGraph& graph_;
  Kept roughness_, normals_;
  device::Buffer rest_, texture_places_;
  std::optional<NormalMap> own_;  // made at first use
};

}  // namespace quadgraph
