// The structs of shaders/source/walk_shared.h lie in memory as the compiled shaders read them.
#include <doctest/doctest.h>

#include <cstddef>

#include "engine/vk/pipeline.h"
#include "shaders/source/walk_shared.h"
#include "spirv/vertex_unscattered.comp.h"
#include "spirv/walk_source.comp.h"
#include "tests/cpp/fixtures/spirv_layout.h"

using namespace quadgraph;

namespace {

using Members = std::map<std::string, std::uint32_t>;

#define MEMBER(Type, name) {#name, static_cast<std::uint32_t>(offsetof(gpu::Type, name))}

}  // namespace

TEST_CASE("the walk and C++ agree on their structs") {
  const SpirvLayout walk((vk::Spirv(walk_source_comp)));
  CHECK(walk.offset.at("BeamRecord") == Members{MEMBER(BeamRecord, kind), MEMBER(BeamRecord, travel_or_from)});
  CHECK(walk.offset.at("Beam") ==
        Members{MEMBER(Beam, way), MEMBER(Beam, colour), MEMBER(Beam, floats), MEMBER(Beam, offset)});
  CHECK(walk.block_stride.at("Beams") == sizeof(gpu::Beam));
  CHECK(walk.offset.at("BodyRef") ==
        Members{MEMBER(BodyRef, vertices), MEMBER(BodyRef, tets), MEMBER(BodyRef, crossings), MEMBER(BodyRef, faces),
                MEMBER(BodyRef, face_tets), MEMBER(BodyRef, face_kinds), MEMBER(BodyRef, optical),
                MEMBER(BodyRef, tet_count), MEMBER(BodyRef, face_count), MEMBER(BodyRef, flags), MEMBER(BodyRef, eta)});
  CHECK(walk.offset.at("WalkSourcePush") ==
        Members{MEMBER(WalkSourcePush, body), MEMBER(WalkSourcePush, beam), MEMBER(WalkSourcePush, beam_q),
                MEMBER(WalkSourcePush, scale), MEMBER(WalkSourcePush, deposit), MEMBER(WalkSourcePush, unscattered),
                MEMBER(WalkSourcePush, sums), MEMBER(WalkSourcePush, rays), MEMBER(WalkSourcePush, fem)});
  CHECK(sizeof(gpu::WalkSourcePush) <= 128);  // what every device of Vulkan 1.3 has room for
  const SpirvLayout vertex((vk::Spirv(vertex_unscattered_comp)));
  CHECK(vertex.offset.at("VertexUnscatteredPush") ==
        Members{MEMBER(VertexUnscatteredPush, vertices), MEMBER(VertexUnscatteredPush, faces),
                MEMBER(VertexUnscatteredPush, face_offset), MEMBER(VertexUnscatteredPush, face_incidence),
                MEMBER(VertexUnscatteredPush, unscattered), MEMBER(VertexUnscatteredPush, scale),
                MEMBER(VertexUnscatteredPush, factor), MEMBER(VertexUnscatteredPush, exitance),
                MEMBER(VertexUnscatteredPush, vertex_unscattered), MEMBER(VertexUnscatteredPush, count)});
}
