#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/render/engine.h"

namespace quadgraph {
namespace {

void check_roughness(float roughness) {
  if (roughness_range.contains(roughness)) return;
  throw InputError("roughness: found " + number_text(roughness) + ", expected " + roughness_range.text());
}

}  // namespace

void check_options(const RenderOptions& options) {
  for (std::uint32_t side : {options.width, options.height}) {
    if (!side_range.contains(side)) {
      throw InputError("size: found " + std::to_string(options.width) + "x" + std::to_string(options.height) +
                       ", expected " + side_range.text() + " pixels a side");
    }
  }
  check_roughness(options.roughness);
  if (!options.roughness_map) return;
  if (!options.roughness_map->image) throw InputError("roughness_map, image: found none");
  check_roughness(options.roughness_map->roughness);
  check_placement(options.roughness_map->placement);
}

}  // namespace quadgraph
