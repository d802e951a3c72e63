// How a volume of coefficients that was found in one body is carried into another: as users write it.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/names.h"
#include "engine/base/range.h"
#include "engine/optics/coat.h"

namespace quadgraph {

enum class MapKind { box, shell, volume };

template <>
struct Names<MapKind> {
  static constexpr std::string_view what = "map";
  static constexpr std::array<Named<MapKind>, 3> values = {
      {{MapKind::box, "box", "the volume's box, stretched to the body's"},
       {MapKind::shell, "shell", "by the place on the surface and the depth below it"},
       {MapKind::volume, "volume", "a harmonic map of the body's tets into the volume's box"}}};
};

// What is beyond the edges of the source.
enum class MapRepeat { mirror, clamp };

template <>
struct Names<MapRepeat> {
  static constexpr std::string_view what = "map: repeat";
  static constexpr std::array<Named<MapRepeat>, 2> values = {
      {{MapRepeat::mirror, "mirror", "the source again, mirrored at its edges"},
       {MapRepeat::clamp, "clamp", "what is at the edge"}}};
};

inline constexpr Range map_scale_range{.low = 0.01, .high = 100}, map_depth_range{.low = 0, .high = 1e6, .above = true};

struct MaterialMap {
  MapKind kind = MapKind::shell;
  float scale = 1;                       // how much larger the source is made: over the body's box, or in mm
  MapRepeat repeat = MapRepeat::mirror;  // beyond the source's edges; clamp where it is `volume`
  std::optional<float> depth{};          // mm of the source below its surface, as far as `shell` goes by its places
  std::filesystem::path from{};          // the .qgraph that the volume was found in; none: the volume's own box

  bool operator==(const MaterialMap&) const = default;
};

// Of "shell,scale=2,repeat=clamp,depth=3,from=block.qgraph", only the first of which must be there. Throws InputError.
MaterialMap parse_map(std::string_view text);

// What parse_map reads back as the same, without what is usual.
std::string to_string(const MaterialMap& map);

// The name of a volume's file, and how it is carried into the body that it is for.
struct VolumeName {
  std::filesystem::path file;
  std::optional<MaterialMap> map{};  // none: it lies in the body as it is
  Coat coat{};
};

// Of a material's text that names a volume, "wax.npz" or "wax.npz,map=shell,scale=2", with a coat or none: .npz in any
// case; nothing for other materials. Throws InputError for what stands behind the name.
std::optional<VolumeName> volume_name(std::string_view material);

std::string to_string(const VolumeName& name);

// A material's text with another map, as parse_map reads it. Throws InputError where it names no volume.
std::string with_map(std::string_view material, std::string_view map);

}  // namespace quadgraph
