#include "engine/render/picture/surface_scene.h"

#include "engine/optics/surface_boundary.h"

namespace quadgraph {
namespace {

gpu::RoughnessMapRef roughness_map(const PlacedRoughness* placed) {
  if (placed == nullptr) return {};
  return {.rest = placed->rest.address(),
          .texels = placed->texels.address(),
          .image = placed->image,
          .box = placed->box,
          .roughness = placed->roughness};
}

gpu::NormalMapRef normal_map(const PlacedNormals* placed) {
  if (placed == nullptr) return {};
  return {.rest = placed->rest.address(),
          .texels = placed->texels.address(),
          .image = placed->image,
          .box = placed->box,
          .strength = placed->strength,
          .by_mesh = placed->by_mesh ? 1u : 0u};
}

}  // namespace

gpu::SurfaceScene surface_scene(const RasterInput& input, const Camera& camera) {
  gpu::SurfaceScene scene{.clip_from_offset = camera.clip_from_offset,
                          .origin = camera.origin,
                          .eye = camera.seen_from(),
                          .reach = camera.reach,
                          .surface = {},
                          .radiance_norm = 0,
                          .roughness = input.roughness,
                          .mirrored = input.mirrored,
                          .light_count = input.shadows.light_count(),
                          .vertices = input.mesh.vertices.address(),
                          .normals = input.mesh.normals.address(),
                          .face = input.mesh.face.address(),
                          .barycentric = input.mesh.barycentric.address(),
                          .faces = input.finest.faces.address(),
                          .face_kinds = input.finest.face_kind.address(),
                          .exitance = input.vertex_exitance.address(),
                          .unscattered = input.vertex_unscattered.address(),
                          .sky = input.finest.sky.address(),
                          .lights = input.shadows.lights().address(),
                          .shapes = input.shadows.shapes().address(),
                          .views = input.shadows.views().address(),
                          .triangles = input.mesh.triangles.address(),
                          .triangle_face = 0,
                          .points = 0,
                          .scale = 0,
                          .share = 0,
                          .elsewhere = {},
                          .solid = {},
                          .roughness_map = roughness_map(input.placed_roughness),
                          .normal_map = normal_map(input.placed_normals)};
  if (input.gather != nullptr) {
    scene.triangle_face = input.gather->triangle_face.address();
    scene.points = input.gather->field.points().address();
    scene.scale = input.gather->field.scale().address();
    scene.solid = input.gather->field.solid();
    if (input.gather->share != nullptr) scene.share = input.gather->share->address();
    const device::Buffer* elsewhere = input.gather->elsewhere;
    for (std::uint64_t k = 0; elsewhere != nullptr && k < gpu::DOUBT_SAMPLES; ++k) {
      scene.elsewhere[k] = elsewhere->address() + k * (elsewhere->size() / gpu::DOUBT_SAMPLES);
    }
  }
  return scene;
}

gpu::SurfaceScene surface_scene(const PathInput& input, const Camera& camera) {
  gpu::SurfaceScene scene{};
  scene.clip_from_offset = camera.clip_from_offset;
  scene.origin = camera.origin;
  scene.eye = camera.seen_from();
  scene.reach = camera.reach;
  scene.surface = single_precision(input.surface);
  scene.roughness = input.roughness;
  scene.mirrored = input.mirrored;
  scene.roughness_map = roughness_map(input.placed_roughness);
  scene.normal_map = normal_map(input.placed_normals);
  scene.radiance_norm = static_cast<float>(radiance_norm(input.surface));
  scene.light_count = input.shadows.light_count();
  scene.vertices = input.mesh.vertices.address();
  scene.normals = input.mesh.normals.address();
  scene.lights = input.shadows.lights().address();
  scene.shapes = input.shadows.shapes().address();
  scene.views = input.shadows.views().address();
  return scene;
}

}  // namespace quadgraph
