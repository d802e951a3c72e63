#include "engine/solve/surface_share.h"

#include "interface/surface/surface_dimmest.comp.h"
#include "interface/surface/surface_share.comp.h"
#include "shaders/surface/surface_shared.h"

namespace quadgraph {

void record_surface_share(Workspace& work, const LevelBuffers& level, Method method, const BodyBoundaries& boundaries,
                          const OperatorBuffers& op) {
  const gpu::SurfaceSharePush push{.vertices = level.vertices.address(),
                                   .faces = level.faces.address(),
                                   .face_kinds = level.face_kind.address(),
                                   .boundaries = boundaries.on_device,
                                   .face_offset = level.face_offset.address(),
                                   .face_incidence = level.face_incidence.address(),
                                   .q = level.q.address(),
                                   .scale = work.scale.address(),
                                   .share = op.surface_share.address(),
                                   .count = op.surface_count,
                                   .fem = on_vertices(method) ? 1u : 0u};
  const std::uint64_t face_bytes = sizeof(glm::uvec3) + 4 * sizeof(glm::vec3) + sizeof(std::uint32_t);
  work.recorder.dispatch(work.passes.of(shader::surface_share), push, op.surface_count, "surface share",
                         3 * level.face_count * face_bytes + op.surface_count * sizeof(gpu::SurfaceShare));
}

void record_surface_dimmest(Workspace& work, const device::Buffer& m, const device::Buffer& share,
                            std::uint32_t count) {
  const gpu::SurfaceDimmestPush push{.m = m.address(), .share = share.address(), .count = count};
  constexpr std::uint64_t bytes = 3 * (sizeof(glm::vec3) + sizeof(gpu::SurfaceShare));
  work.recorder.dispatch(work.passes.of(shader::surface_dimmest), push, WORKGROUP_SIZE, "surface share", count * bytes);
}

}  // namespace quadgraph
