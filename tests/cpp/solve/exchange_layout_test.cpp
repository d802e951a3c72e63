// The structs of shaders/exchange/exchange_shared.h lie in memory as the compiled shaders read them.
#include <doctest/doctest.h>

#include <cstddef>

#include "engine/vk/pipeline.h"
#include "shaders/exchange/exchange_shared.h"
#include "spirv/exchange.comp.h"
#include "spirv/exchange_boxes.comp.h"
#include "spirv/exchange_enter.comp.h"
#include "spirv/exchange_finer.comp.h"
#include "spirv/exchange_rays.comp.h"
#include "tests/cpp/fixtures/spirv_layout.h"

using namespace quadgraph;

namespace {

using Members = std::map<std::string, std::uint32_t>;

#define MEMBER(Type, name) {#name, static_cast<std::uint32_t>(offsetof(gpu::Type, name))}

}  // namespace

TEST_CASE("the exchange and C++ agree on their structs") {
  const SpirvLayout exchange((vk::Spirv(exchange_comp)));
  CHECK(exchange.offset.at("ExchangeState") ==
        Members{MEMBER(ExchangeState, power), MEMBER(ExchangeState, change), MEMBER(ExchangeState, entered)});
  CHECK(exchange.block_stride.at("ExchangeStates") == sizeof(gpu::ExchangeState));
  CHECK(SpirvLayout((vk::Spirv(exchange_comp))).offset.at("ExchangePush") ==
        Members{MEMBER(ExchangePush, vertices), MEMBER(ExchangePush, faces), MEMBER(ExchangePush, face_kinds),
                MEMBER(ExchangePush, rows), MEMBER(ExchangePush, entries), MEMBER(ExchangePush, exitance),
                MEMBER(ExchangePush, clip), MEMBER(ExchangePush, before), MEMBER(ExchangePush, irradiance),
                MEMBER(ExchangePush, factor), MEMBER(ExchangePush, state), MEMBER(ExchangePush, reduction),
                MEMBER(ExchangePush, count), MEMBER(ExchangePush, rays), MEMBER(ExchangePush, transmitted)});
  CHECK(sizeof(gpu::ExchangePush) <= 128);  // what every device of Vulkan 1.3 has room for
  CHECK(SpirvLayout((vk::Spirv(exchange_finer_comp))).offset.at("ExchangeFinerPush") ==
        Members{
            MEMBER(ExchangeFinerPush, vertices), MEMBER(ExchangeFinerPush, faces),
            MEMBER(ExchangeFinerPush, face_kinds), MEMBER(ExchangeFinerPush, index), MEMBER(ExchangeFinerPush, weight),
            MEMBER(ExchangeFinerPush, coarse), MEMBER(ExchangeFinerPush, irradiance), MEMBER(ExchangeFinerPush, factor),
            MEMBER(ExchangeFinerPush, state), MEMBER(ExchangeFinerPush, reduction), MEMBER(ExchangeFinerPush, count),
            MEMBER(ExchangeFinerPush, width), MEMBER(ExchangeFinerPush, transmitted)});
  CHECK(sizeof(gpu::ExchangeFinerPush) <= 128);  // what every device of Vulkan 1.3 has room for
  CHECK(SpirvLayout((vk::Spirv(exchange_enter_comp))).offset.at("ExchangeEnterPush") ==
        Members{MEMBER(ExchangeEnterPush, vertices), MEMBER(ExchangeEnterPush, faces), MEMBER(ExchangeEnterPush, q),
                MEMBER(ExchangeEnterPush, irradiance), MEMBER(ExchangeEnterPush, beam_q),
                MEMBER(ExchangeEnterPush, factor), MEMBER(ExchangeEnterPush, state),
                MEMBER(ExchangeEnterPush, reduction), MEMBER(ExchangeEnterPush, count),
                MEMBER(ExchangeEnterPush, transmitted)});
  CHECK(sizeof(gpu::ExchangeEnterPush) <= 128);  // what every device of Vulkan 1.3 has room for
  CHECK(SpirvLayout((vk::Spirv(exchange_boxes_comp))).offset.at("ExchangeBoxesPush") ==
        Members{MEMBER(ExchangeBoxesPush, vertices), MEMBER(ExchangeBoxesPush, faces), MEMBER(ExchangeBoxesPush, order),
                MEMBER(ExchangeBoxesPush, leaf_begin), MEMBER(ExchangeBoxesPush, boxes),
                MEMBER(ExchangeBoxesPush, first), MEMBER(ExchangeBoxesPush, count),
                MEMBER(ExchangeBoxesPush, leaf_count)});
  CHECK(sizeof(gpu::ExchangeBoxesPush) <= 128);  // what every device of Vulkan 1.3 has room for
  CHECK(SpirvLayout((vk::Spirv(exchange_rays_comp))).offset.at("ExchangeRaysPush") ==
        Members{MEMBER(ExchangeRaysPush, vertices), MEMBER(ExchangeRaysPush, faces), MEMBER(ExchangeRaysPush, order),
                MEMBER(ExchangeRaysPush, leaf_begin), MEMBER(ExchangeRaysPush, boxes), MEMBER(ExchangeRaysPush, rows),
                MEMBER(ExchangeRaysPush, entries), MEMBER(ExchangeRaysPush, first),
                MEMBER(ExchangeRaysPush, face_count), MEMBER(ExchangeRaysPush, leaf_count),
                MEMBER(ExchangeRaysPush, rays)});
  CHECK(sizeof(gpu::ExchangeRaysPush) <= 128);  // what every device of Vulkan 1.3 has room for
  const SpirvLayout boxes((vk::Spirv(exchange_boxes_comp)));
  CHECK(boxes.offset.at("Box") == Members{MEMBER(Box, low), MEMBER(Box, high)});
  CHECK(boxes.block_stride.at("Boxes") == sizeof(gpu::Box));
}
