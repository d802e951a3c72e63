#include "engine/render/picture/ground_light.h"

#include <algorithm>
#include <span>

#include "engine/file/face_tree.h"
#include "interface/display/ground_light.comp.h"
#include "interface/display/ground_patches.comp.h"
#include "shaders/display/ground_shared.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t light_texels = std::uint64_t{gpu::GROUND_LIGHT_SIZE} * gpu::GROUND_LIGHT_SIZE;

std::uint32_t quotient_up(std::uint32_t a, std::uint32_t b) {
  return (a + b - 1) / b;
}

}  // namespace

// Faces that lie together follow each other in the tree's order.
GroundLight::GroundLight(device::Device& device, const Level& level)
    : patches_pass_(device, shader::ground_patches),
      light_pass_(device, shader::ground_light),
      face_count_(level.face_count()),
      patch_faces_(std::max(quotient_up(face_count_, gpu::GROUND_PATCHES), 1u)),
      patch_count_(quotient_up(face_count_, patch_faces_)),
      order_(device::upload<std::uint32_t>(device, face_tree(level, [&] { device.heed(); }).order,
                                           "picture/ground order")),
      patches_(device, sizeof(gpu::GroundPatch) * patch_count_, device::Place::device, "picture/ground patches"),
      light_(device, sizeof(glm::vec4) * light_texels, device::Place::device, "picture/ground light") {}

void GroundLight::record(device::Commands& commands, const GroundSource& source, const GroundPart& part) {
  commands.dispatch(patches_pass_,
                    gpu::GroundPatchesPush{.vertices = source.level.vertices.address(),
                                           .faces = source.level.faces.address(),
                                           .face_kinds = source.level.face_kind.address(),
                                           .exitance = source.exitance.address(),
                                           .order = order_.address(),
                                           .patches = patches_.address(),
                                           .face_count = face_count_,
                                           .patch_faces = patch_faces_},
                    patch_count_);
  commands.dispatch(light_pass_,
                    gpu::GroundLightPush{.patches = patches_.address(),
                                         .light = light_.address(),
                                         .middle = part.middle,
                                         .half_width = part.half_width,
                                         .z_up = part.z_up ? 1u : 0u,
                                         .patch_count = patch_count_},
                    light_texels);
}

std::uint64_t GroundLight::bytes() const {
  const std::uint64_t of_face = 2 * sizeof(std::uint32_t) + sizeof(glm::uvec3) + 4 * sizeof(glm::vec3);
  return face_count_ * of_face + 2 * sizeof(gpu::GroundPatch) * patch_count_ + light_.size();
}

}  // namespace quadgraph
