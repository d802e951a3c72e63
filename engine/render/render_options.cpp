#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/optics/material.h"
#include "engine/render/engine.h"
#include "engine/render/picture/frame_offsets.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t samples_of_edges = 16, samples_of_blur = 256;

void check_roughness(float roughness) {
  if (roughness_range.contains(roughness)) return;
  throw InputError("roughness: found " + number_text(roughness) + ", expected " + roughness_range.text());
}

void check_convergence(const RenderOptions& options) {
  if (!converge_range.contains(options.converge)) {
    throw InputError("converge: found " + number_text(options.converge) + ", expected " + converge_range.text());
  }
  if (!time_limit_range.contains(options.time_limit)) {
    throw InputError("time_limit: found " + number_text(options.time_limit) + " s, expected " +
                     time_limit_range.text());
  }
}

void check_normal_map(const RenderOptions& options) {
  const auto& map = options.normal_map;
  if (!map) return;
  if (!map->slopes) throw InputError("normal_map, image: found none");
  if (!normal_map_strength_range.contains(map->strength)) {
    throw InputError("normal_map, strength: found " + number_text(map->strength) + ", expected " +
                     normal_map_strength_range.text());
  }
  if (map->placement) check_placement(*map->placement);
}

}  // namespace

std::uint32_t frame_count(const View& view, const RenderOptions& options) {
  const std::uint32_t needed = view.aperture > 0 ? samples_of_blur : samples_of_edges;
  const std::uint32_t samples = options.samples > 0 ? options.samples : needed;
  return (samples + samples_per_frame - 1) / samples_per_frame;
}

void check_options(const RenderOptions& options) {
  for (std::uint32_t side : {options.width, options.height}) {
    if (!side_range.contains(side)) {
      throw InputError("size: found " + std::to_string(options.width) + "x" + std::to_string(options.height) +
                       ", expected " + side_range.text() + " pixels a side");
    }
  }
  if (!samples_range.contains(options.samples)) {
    throw InputError("samples: found " + std::to_string(options.samples) + ", expected " + samples_range.text());
  }
  if (options.roughness) check_roughness(*options.roughness);
  if (options.transmission_roughness && !transmission_range.contains(*options.transmission_roughness)) {
    throw InputError("transmission_roughness: found " + number_text(*options.transmission_roughness) + ", expected " +
                     transmission_range.text());
  }
  check_convergence(options);
  check_normal_map(options);
  if (!options.roughness_map) return;
  if (!options.roughness_map->image) throw InputError("roughness_map, image: found none");
  check_roughness(options.roughness_map->roughness);
  check_placement(options.roughness_map->placement);
}

}  // namespace quadgraph
