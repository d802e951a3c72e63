// Types of lights, shadow maps and the display that GLSL and C++ share, in scalar layout;
// tests/cpp/render/layout_test.cpp compares them with the compiled shaders.
#ifndef QUADGRAPH_RENDER_SHARED_H
#define QUADGRAPH_RENDER_SHARED_H

#include "gather/gather_shared.h"
#include "light/light_kinds.h"
#include "shared/image_levels.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Bits of the variant of a pipeline, which is a specialization constant (shaped.glsl).
#define VARIANT_SHAPED 1
#define VARIANT_PLACED_ROUGHNESS 2

// Pictures of an environment, one after the other in its texels (environment.h).
const uint ENVIRONMENT_COLUMNS = 256u;
const uint ENVIRONMENT_ROWS = 128u;
const uint ENVIRONMENT_ENTERING = 0u;          // irradiance that enters a face, by its normal
const uint ENVIRONMENT_RAYS = 1u;              // radiance as the rays see it that ask what hides it
const uint ENVIRONMENT_REFLECTED = 2u;         // radiance as a rough surface reflects it, by the mirrored view
const uint ENVIRONMENT_REFLECTED_PLACED = 3u;  // the same where the image of a roughness is white
const uint ENVIRONMENT_PICTURES = 4u;

// Texels along a side of a shadow map: of a single view, and of each of a point light's six; of a patch.
const uint SHADOW_SIZE = 2048u;
const uint SHADOW_CUBE_SIZE = 1024u;
const uint SHADOW_PATCH_SIZE = 1024u;
const uint SHADOW_PATCH_CUBE_SIZE = 512u;

// A shadow map holds the depth of the faces turned away from the light. On a closed body a lit point then lies a whole
// thickness in front of its own depth, so that no bias is needed against self-shadowing but near the terminator, where
// nearly no light arrives; and it also holds for points of coarser levels, which lie somewhat below the surface. What
// remains is moved out by this many texels along the normal.
const float SHADOW_NORMAL_OFFSET = 1.0f;

// One view of one light's shadow map.
struct ShadowView {
  mat4 clip_from_world;
  QG_REF(Floats) depth;  // `size` rows of `size` texels, top row first; 0 at `near` to 1 at `far`
  uint size;             // texels
  float near;            // mm
  float far;             // mm
  float texel;           // directional: mm; point: mm at 1 mm from the light
};

#ifndef __cplusplus
QG_ARRAY(ShadowViews, ShadowView);
QG_ARRAY(LightRecords, LightRecord);
QG_ARRAY(LightShapes, LightShape);

ShadowView load_shadow_view(ShadowViews a, uint i) {
  if (TEXELS) {
    uint t = texel_of(uvec2(a)) + 22u * i;
    return ShadowView(mat4_in_texels(t), Floats(texels2(t + 16u)), texel(t + 18u), uintBitsToFloat(texel(t + 19u)),
                      uintBitsToFloat(texel(t + 20u)), uintBitsToFloat(texel(t + 21u)));
  }
  return a.at[i];
}

LightRecord load_light(LightRecords a, uint i) {
  if (TEXELS) {
    uint t = texel_of(uvec2(a)) + 9u * i;
    return LightRecord(texel(t), uintBitsToFloat(texels3(t + 1u)), uintBitsToFloat(texels3(t + 4u)), texel(t + 7u),
                       texel(t + 8u));
  }
  return a.at[i];
}

LightShape load_light_shape(LightShapes a, uint i) {
  if (TEXELS) {
    uint t = texel_of(uvec2(a)) + 20u * i;
    return LightShape(uintBitsToFloat(texels3(t)), uintBitsToFloat(texel(t + 3u)), uintBitsToFloat(texel(t + 4u)),
                      uintBitsToFloat(texel(t + 5u)), uintBitsToFloat(texel(t + 6u)), texel(t + 7u),
                      uintBitsToFloat(texels3(t + 8u)), uintBitsToFloat(texels3(t + 11u)), Vec3s(texels2(t + 14u)),
                      texel(t + 16u), texel(t + 17u), texel(t + 18u), texel(t + 19u));
  }
  return a.at[i];
}
#endif

// shadow.vert: depth of the display mesh.
struct ShadowPush {
  mat4 clip_from_world;
  QG_REF(Vec3s) vertices;  // mm
};

// irradiance.comp: q of every outside face of a level, the mean over the face, and what each light brings to its
// quarters.
struct IrradiancePush {
  QG_REF(Vec3s) vertices;  // mm
  QG_REF(Uvec3s) faces;
  QG_REF(Vec3s) q;        // W/mm^2, written
  QG_REF(Floats) beam_q;  // per beam what gpu::Beam says: shares of its power; written
  QG_REF(Floats) sky;     // per face: share of ambient light that other parts of the body do not hide
  QG_REF(Vec3s) hidden;   // per environment and face: what they hide of it, as q; null: by the share of the sky
  QG_REF(LightRecords) lights;
  QG_REF(LightShapes) shapes;  // per light
  QG_REF(ShadowViews) views;
  uint face_count;
  uint light_count;
  uint subdivision;  // even: the face is sampled at the centroids of subdivision^2 equal triangles
  float eta;
  float diffuse_transmittance;  // of a smooth surface under even light from outside
};

// environment_hidden.comp: what the body hides of every environment from the faces of the level whose rays are known,
// as q over its power. environment_finer.comp: the same on a level from the next coarser one.
struct EnvironmentHiddenPush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uvec2s) rows;  // as ExchangePush
  QG_REF(Uints) entries;
  QG_REF(LightRecords) lights;
  QG_REF(LightShapes) shapes;
  QG_REF(Vec3s) hidden;  // written
  uint face_count;
  uint light_count;
  float rays;  // per face
  float eta;
};
struct EnvironmentFinerPush {
  QG_REF(Uints) index;
  QG_REF(Floats) weight;
  QG_REF(Vec3s) coarse;
  QG_REF(Vec3s) hidden;  // written
  uint width;
  uint face_count;
  uint coarse_count;
  uint environments;
};

// All that surface.vert and surface.frag read.
struct SurfaceScene {
  mat4 clip_from_world;
  vec3 eye;  // mm
  float eta;
  float roughness;      // GGX alpha
  float radiance_norm;  // integral of F_t cos over the hemisphere, sr
  uint light_count;
  QG_REF(Vec3s) vertices;     // display mesh, mm
  QG_REF(Vec3s) normals;      // unit
  QG_REF(Uints) face;         // per display vertex: outside face of level 0
  QG_REF(Vec3s) barycentric;  // and where in it
  QG_REF(Uvec3s) faces;       // level 0
  QG_REF(Vec3s) exitance;     // per surface vertex of level 0, W/mm^2
  QG_REF(Vec3s) unscattered;  // the same
  QG_REF(Floats) sky;         // per face of level 0: share of even light from outside that the body does not hide
  QG_REF(LightRecords) lights;
  QG_REF(LightShapes) shapes;  // per light
  QG_REF(ShadowViews) views;
  QG_REF(Uints) triangles;      // of the display mesh: three display vertices each
  QG_REF(Uints) triangle_face;  // per display triangle: outside face of level 0
  QG_REF(GatherPoints) points;
  QG_REF(GatherScales) scale;
  SolidRef solid;
};

#ifndef __cplusplus
QG_ARRAY(SurfaceScenes, SurfaceScene);

// The only one of an array.
SurfaceScene load_scene(SurfaceScenes a) {
  if (!TEXELS) return a.at[0];
  uint t = texel_of(uvec2(a));
  SurfaceScene scene;
  scene.clip_from_world = mat4_in_texels(t);
  scene.eye = uintBitsToFloat(texels3(t + 16u));
  scene.eta = uintBitsToFloat(texel(t + 19u));
  scene.roughness = uintBitsToFloat(texel(t + 20u));
  scene.radiance_norm = uintBitsToFloat(texel(t + 21u));
  scene.light_count = texel(t + 22u);
  scene.vertices = Vec3s(texels2(t + 24u));
  scene.normals = Vec3s(texels2(t + 26u));
  scene.face = Uints(texels2(t + 28u));
  scene.barycentric = Vec3s(texels2(t + 30u));
  scene.faces = Uvec3s(texels2(t + 32u));
  scene.exitance = Vec3s(texels2(t + 34u));
  scene.unscattered = Vec3s(texels2(t + 36u));
  scene.sky = Floats(texels2(t + 38u));
  scene.lights = LightRecords(texels2(t + 40u));
  scene.shapes = LightShapes(texels2(t + 42u));
  scene.views = ShadowViews(texels2(t + 44u));
  scene.triangles = Uints(texels2(t + 46u));
  scene.triangle_face = Uints(texels2(t + 48u));
  scene.points = GatherPoints(texels2(t + 50u));
  scene.scale = GatherScales(texels2(t + 52u));
  scene.solid = solid_in_texels(t + 54u);
  return scene;
}
#endif

// surface.vert, surface.frag: radiance of the display mesh. surface_gathered.vert, surface_gathered.frag: what is
// needed to gather it.
struct SurfacePush {
  QG_REF(SurfaceScenes) scene;  // one
  // With VARIANT_PLACED_ROUGHNESS: engine/render/display/surface_roughness.h.
  QG_REF(Vec3s) rest;    // per display vertex, mm
  QG_REF(Vec3s) texels;  // of the image
  ImageLevels image;
  ImageBox box;
  float roughness;  // GGX alpha where the image is white
};

// Layers of a picture: scattered, specular and unscattered radiance, and transmittance.
#define PICTURE_LAYERS 4
// Images of samples. surface.frag: scattered radiance and coverage, specular, unscattered. surface_gathered.frag:
// position and coverage; specular and the high half of the face; normal and its low half.
#define SAMPLE_LAYERS 3
#define FACE_HALF 65536

// resolve.comp, gather.comp: mean of 2 x 2 samples of a tile into the picture.
struct ResolvePush {
  QG_REF(SurfaceScenes) scene;  // one
  QG_REF(Vec4s) samples[SAMPLE_LAYERS];
  QG_REF(Floats) layers[PICTURE_LAYERS];  // RGB per pixel, written
  QG_REF(Floats) alpha;                   // per pixel, written
  uint tile_x;                            // first pixel of the tile in the picture
  uint tile_y;
  uint tile_width;  // pixels of the tile inside the picture
  uint tile_height;
  uint sample_stride;  // samples in a row of the tile
  uint picture_width;  // pixels
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
