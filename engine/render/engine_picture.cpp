// What an engine draws of the body.
#include "engine/reference/tet_points.h"
#include "engine/render/engine_implementation.h"

namespace quadgraph {

static_assert(gpu::DOUBT_SAMPLES == points_of_a_tet, "a picture is compared with all that is known of a tet");

Radiance Engine::Implementation::draw_surface(const Camera& camera, const RenderOptions& render,
                                              const PictureFrame& frame) {
  std::optional<PlacedRoughness> placed;
  if (render.roughness_map) placed.emplace(maps.placed(*render.roughness_map));
  const BodyRoughness* own = own_roughness(render);
  if (auto by_body = own ? own->placed() : std::nullopt) placed.emplace(*by_body);
  const PlacedRoughness* there = placed ? &*placed : nullptr;
  std::optional<PlacedNormals> leaning;
  if (const auto& map = normals(render)) leaning.emplace(maps.placed(*map));
  const PlacedNormals* normals = leaning ? &*leaning : nullptr;
  if (report->path) {
    if (render.radiance == Radiance::gathered || render.radiance == Radiance::single) {
      throw InputError("radiance: with shortest-path nothing is gathered, allowed are lambertian, auto");
    }
    if (shadows_stale) cast_shadows();
    add_all(rasteriser.run(PathInput{.mesh = mesh,
                                     .field = paths.field(),
                                     .shadows = shadows,
                                     .surface = surfaces[0].smooth(),
                                     .roughness = roughness(render),
                                     .placed_roughness = there,
                                     .placed_normals = normals,
                                     .mirrored = mirrored(render)},
                           camera, render.width, render.height));
    return Radiance::lambertian;
  }
  std::optional<GatherView> view_rays;
  Radiance leaves = render.radiance;
  if (leaves == Radiance::automatic) {
    leaves = simulation->can_gather() ? Radiance::gathered : Radiance::lambertian;
  }
  if (leaves != Radiance::lambertian) {
    const GatherField& field = gather(leaves == Radiance::single ? Gather::single : Gather::scaled);
    const bool whole = leaves == Radiance::gathered;
    view_rays.emplace(field, triangle_face, whole ? simulation->surface_share() : nullptr,
                      whole ? simulation->elsewhere() : nullptr);
  }
  add_all(rasteriser.run(RasterInput{.mesh = mesh,
                                     .finest = simulation->level(0),
                                     .vertex_exitance = simulation->vertex_exitance(),
                                     .vertex_unscattered = simulation->vertex_unscattered(),
                                     .shadows = shadows,
                                     .roughness = roughness(render),
                                     .placed_roughness = there,
                                     .placed_normals = normals,
                                     .mirrored = mirrored(render),
                                     .gather = view_rays ? &*view_rays : nullptr,
                                     .transmission_roughness = render.transmission_roughness,
                                     .frame = frame,
                                     .filter = render.filter},
                         camera, render.width, render.height));
  return leaves;
}

void Engine::Implementation::draw_picture(const View& from, const Camera& camera, const RenderOptions& render,
                                          const PictureFrame& frame) {
  legend.reset();
  const glm::vec2 blurred = mirrored(render);
  images.set_roughness(blurred.x, blurred.y, coat_roughness());
  radiance = draw_surface(camera, render, frame);
  if (render.ground) {
    if (!ground) ground.emplace(device);
    add_all(ground->run(mesh, bounds, from, camera, rasteriser.picture(), ground_source()));
  }
  if (render.surroundings) {
    if (!surroundings) surroundings.emplace(device);
    PictureBuffers& picture = rasteriser.picture();
    PassStats pass;
    picture.has_surroundings = surroundings->run(lights, camera, picture, pass);
    if (picture.has_surroundings) add(render_passes, pass);
  }
}

}  // namespace quadgraph
