// The structs of shaders/light/render_shared.h lie in memory as the compiled shaders read them.
#include "shaders/display/display_shared.h"
#include "shaders/display/false_colour_shared.h"
#include "shaders/display/ground_shared.h"
#include "shaders/display/surroundings_shared.h"
#include "shaders/light/render_shared.h"
#include "shaders/path/path_light_shared.h"
#include "spirv/false_colour.frag.h"
#include "spirv/false_colour.vert.h"
#include "spirv/ground.comp.h"
#include "spirv/ground_map.comp.h"
#include "spirv/irradiance.comp.h"
#include "spirv/luminance.comp.h"
#include "spirv/path_enter.comp.h"
#include "spirv/resolve.comp.h"
#include "spirv/shadow.vert.h"
#include "spirv/surface.frag.h"
#include "spirv/surface.vert.h"
#include "spirv/surface_gathered.frag.h"
#include "spirv/surface_gathered.vert.h"
#include "spirv/surface_path.frag.h"
#include "spirv/surface_path.vert.h"
#include "spirv/surroundings.comp.h"
#include "spirv/tone_map.comp.h"
#include "tests/cpp/fixtures/layout_compare.h"

using namespace quadgraph;

TEST_CASE("lights and shadow views") {
  for (const vk::Spirv code : {vk::Spirv(irradiance_comp), vk::Spirv(surface_frag)}) {
    const SpirvLayout layout(code);
    compare(code, "ShadowView",
            {MEMBER(ShadowView, clip_from_world), MEMBER(ShadowView, depth), MEMBER(ShadowView, size),
             MEMBER(ShadowView, near), MEMBER(ShadowView, far), MEMBER(ShadowView, texel)});
    compare(code, "LightRecord",
            {MEMBER(LightRecord, kind), MEMBER(LightRecord, towards_or_at), MEMBER(LightRecord, power),
             MEMBER(LightRecord, first_view), MEMBER(LightRecord, view_count)});
    compare(code, "LightShape",
            {MEMBER(LightShape, axis), MEMBER(LightShape, inner), MEMBER(LightShape, outer), MEMBER(LightShape, share),
             MEMBER(LightShape, width), MEMBER(LightShape, more_follow), MEMBER(LightShape, right),
             MEMBER(LightShape, up), MEMBER(LightShape, texels), MEMBER(LightShape, columns), MEMBER(LightShape, rows),
             MEMBER(LightShape, levels), MEMBER(LightShape, parts)});
    CHECK(layout.stride.at("LightShape") == sizeof(gpu::LightShape));
    CHECK(layout.stride.at("ShadowView") == sizeof(gpu::ShadowView));
    CHECK(layout.stride.at("LightRecord") == sizeof(gpu::LightRecord));
  }
}

TEST_CASE("the scene of the display") {
  for (const vk::Spirv code : {vk::Spirv(surface_vert), vk::Spirv(surface_frag), vk::Spirv(surface_gathered_vert),
                               vk::Spirv(surface_gathered_frag)}) {
    const SpirvLayout layout(code);
    compare(code, "SurfaceScene",
            {MEMBER(SurfaceScene, clip_from_world),
             MEMBER(SurfaceScene, eye),
             MEMBER(SurfaceScene, eta),
             MEMBER(SurfaceScene, roughness),
             MEMBER(SurfaceScene, radiance_norm),
             MEMBER(SurfaceScene, light_count),
             MEMBER(SurfaceScene, vertices),
             MEMBER(SurfaceScene, normals),
             MEMBER(SurfaceScene, face),
             MEMBER(SurfaceScene, barycentric),
             MEMBER(SurfaceScene, faces),
             MEMBER(SurfaceScene, exitance),
             MEMBER(SurfaceScene, unscattered),
             MEMBER(SurfaceScene, sky),
             MEMBER(SurfaceScene, lights),
             MEMBER(SurfaceScene, shapes),
             MEMBER(SurfaceScene, views),
             MEMBER(SurfaceScene, triangles),
             MEMBER(SurfaceScene, triangle_face),
             MEMBER(SurfaceScene, points),
             MEMBER(SurfaceScene, scale),
             MEMBER(SurfaceScene, solid)});
    CHECK(layout.stride.at("SurfaceScene") == sizeof(gpu::SurfaceScene));
    compare(code, "SurfacePush",
            {MEMBER(SurfacePush, scene), MEMBER(SurfacePush, rest), MEMBER(SurfacePush, texels),
             MEMBER(SurfacePush, image), MEMBER(SurfacePush, box), MEMBER(SurfacePush, roughness)});
  }
}

TEST_CASE("push constants") {
  compare(shadow_vert, "ShadowPush", {MEMBER(ShadowPush, clip_from_world), MEMBER(ShadowPush, vertices)});
  compare(irradiance_comp, "IrradiancePush",
          {MEMBER(IrradiancePush, vertices), MEMBER(IrradiancePush, faces), MEMBER(IrradiancePush, q),
           MEMBER(IrradiancePush, beam_q), MEMBER(IrradiancePush, sky), MEMBER(IrradiancePush, hidden),
           MEMBER(IrradiancePush, lights), MEMBER(IrradiancePush, shapes), MEMBER(IrradiancePush, views),
           MEMBER(IrradiancePush, face_count), MEMBER(IrradiancePush, light_count), MEMBER(IrradiancePush, subdivision),
           MEMBER(IrradiancePush, eta), MEMBER(IrradiancePush, diffuse_transmittance)});
  compare(resolve_comp, "ResolvePush",
          {MEMBER(ResolvePush, scene), MEMBER(ResolvePush, samples), MEMBER(ResolvePush, layers),
           MEMBER(ResolvePush, alpha), MEMBER(ResolvePush, tile_x), MEMBER(ResolvePush, tile_y),
           MEMBER(ResolvePush, tile_width), MEMBER(ResolvePush, tile_height), MEMBER(ResolvePush, sample_stride),
           MEMBER(ResolvePush, picture_width)});
}

TEST_CASE("views of the inside") {
  compare(false_colour_vert, "FalseVertex",
          {MEMBER(FalseVertex, position), MEMBER(FalseVertex, value), MEMBER(FalseVertex, flags)});
  CHECK(SpirvLayout(false_colour_vert).stride.at("FalseVertex") == sizeof(gpu::FalseVertex));
  for (const vk::Spirv code : {vk::Spirv(false_colour_vert), vk::Spirv(false_colour_frag)}) {
    compare(code, "FalseColourPush",
            {MEMBER(FalseColourPush, clip_from_world), MEMBER(FalseColourPush, vertices), MEMBER(FalseColourPush, eye),
             MEMBER(FalseColourPush, plane), MEMBER(FalseColourPush, diverging)});
  }
}

TEST_CASE("what brings a picture to a screen") {
  compare(luminance_comp, "LuminancePush",
          {MEMBER(LuminancePush, layers), MEMBER(LuminancePush, alpha), MEMBER(LuminancePush, bins),
           MEMBER(LuminancePush, count)});
  compare(tone_map_comp, "ToneMapPush",
          {MEMBER(ToneMapPush, layers), MEMBER(ToneMapPush, alpha), MEMBER(ToneMapPush, surroundings),
           MEMBER(ToneMapPush, target), MEMBER(ToneMapPush, background_top), MEMBER(ToneMapPush, background_bottom),
           MEMBER(ToneMapPush, exposure), MEMBER(ToneMapPush, picture_width), MEMBER(ToneMapPush, picture_height),
           MEMBER(ToneMapPush, width), MEMBER(ToneMapPush, height), MEMBER(ToneMapPush, false_colour),
           MEMBER(ToneMapPush, blue_first), MEMBER(ToneMapPush, surrounded)});
  compare(surroundings_comp, "SurroundingsPush",
          {MEMBER(SurroundingsPush, texels), MEMBER(SurroundingsPush, surroundings), MEMBER(SurroundingsPush, image),
           MEMBER(SurroundingsPush, corner), MEMBER(SurroundingsPush, right), MEMBER(SurroundingsPush, down),
           MEMBER(SurroundingsPush, power), MEMBER(SurroundingsPush, width), MEMBER(SurroundingsPush, height),
           MEMBER(SurroundingsPush, first)});
}

TEST_CASE("the ground") {
  compare(ground_map_comp, "GroundMapPush",
          {MEMBER(GroundMapPush, depth), MEMBER(GroundMapPush, shadow), MEMBER(GroundMapPush, far),
           MEMBER(GroundMapPush, reach)});
  compare(ground_comp, "GroundPush",
          {MEMBER(GroundPush, shadow), MEMBER(GroundPush, alpha), MEMBER(GroundPush, eye), MEMBER(GroundPush, corner),
           MEMBER(GroundPush, right), MEMBER(GroundPush, down), MEMBER(GroundPush, half_width),
           MEMBER(GroundPush, z_up), MEMBER(GroundPush, width), MEMBER(GroundPush, height)});
}

TEST_CASE("what lights and shows the cells of shortest paths") {
  compare(path_enter_comp, "PathEnterPush",
          {MEMBER(PathEnterPush, grid), MEMBER(PathEnterPush, vertices), MEMBER(PathEnterPush, triangles),
           MEMBER(PathEnterPush, flags), MEMBER(PathEnterPush, entering), MEMBER(PathEnterPush, lights),
           MEMBER(PathEnterPush, shapes), MEMBER(PathEnterPush, views), MEMBER(PathEnterPush, tools),
           MEMBER(PathEnterPush, triangle_count), MEMBER(PathEnterPush, stripes), MEMBER(PathEnterPush, light_count),
           MEMBER(PathEnterPush, eta), MEMBER(PathEnterPush, diffuse_transmittance)});
  compare(surface_path_frag, "PathField",
          {MEMBER(PathField, grid), MEMBER(PathField, field), MEMBER(PathField, tools)});
  for (const vk::Spirv code : {vk::Spirv(surface_path_vert), vk::Spirv(surface_path_frag)}) {
    compare(code, "SurfacePathPush", {MEMBER(SurfacePathPush, surface), MEMBER(SurfacePathPush, field)});
  }
}
