// Types of lights, shadow maps and the display that GLSL and C++ share, in scalar layout; see shared.h.
#ifndef QUADGRAPH_RENDER_SHARED_H
#define QUADGRAPH_RENDER_SHARED_H

#include "gather/gather_shared.h"
#include "light/light_kinds.h"
#include "shared/environment_picture.h"
#include "shared/eye.h"
#include "shared/image_levels.h"
#include "surface/surface_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

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

// light_error.comp: samples of the light on a face that share nothing, and turns in which the points of each are taken.
const uint LIGHT_SAMPLES = 2u;
const uint LIGHT_TURNS = 4u;

#ifndef __cplusplus
QG_ARRAY(ShadowViews, ShadowView);
QG_ARRAY(LightRecords, LightRecord);
QG_ARRAY(LightShapes, LightShape);

#endif

// An image of how rough the surface is (engine/render/display/surface_roughness.h).
struct RoughnessMapRef {
  QG_REF(Vec3s) rest;    // per display vertex, mm
  QG_REF(Vec3s) texels;  // of the image; null: the roughness is the same everywhere
  ImageLevels image;
  ImageBox box;
  float roughness;  // GGX alpha where the image is white
};

// A picture of how the surface leans (engine/render/display/normal_map.h): slopes along the picture's right and up, and
// the mean of their squared length [Olano 2010].
struct NormalMapRef {
  QG_REF(Vec3s) rest;    // per display vertex, mm; or by coordinates of the mesh: u, v downwards, 1 where it lies
  QG_REF(Vec3s) texels;  // of the image; null: it leans nowhere
  ImageLevels image;
  ImageBox box;
  float strength;
  uint by_mesh;  // 1: by coordinates of the mesh
};

// How far a picture depends on where in tets the material is taken is told by blocks of pixels, of so many along a
// side, in each by one of so many samples of the material and by one pixel of so many along a row and down.
const uint DOUBT_BLOCK = 4u;
const uint DOUBT_SAMPLES = 4u;
const uint DOUBT_STRIDE = 2u;

// All that the display's surface is drawn and shaded by.
struct SurfaceScene {
  mat4 clip_from_offset;  // of what is `origin` (mm) less than a place: engine/render/display/camera.h
  vec3 origin;
  vec4 eye;                // shared/eye.h
  float reach;             // mm, more than the body is wide
  OpticalSurface surface;  // surface_path.frag alone, as is the next: of the one material of what has no levels
  float radiance_norm;     // as of Refraction
  float roughness;         // GGX alpha
  vec2 mirrored;           // GGX alpha by which ENVIRONMENT_REFLECTED and ENVIRONMENT_REFLECTED_PLACED are blurred
  uint light_count;
  QG_REF(Vec3s) vertices;     // display mesh, mm
  QG_REF(Vec3s) normals;      // unit
  QG_REF(Uints) face;         // per display vertex: outside face of level 0
  QG_REF(Vec3s) barycentric;  // and where in it
  QG_REF(Uvec3s) faces;       // level 0
  QG_REF(Uints) face_kinds;   // the same
  QG_REF(Vec3s) exitance;     // per surface vertex of level 0, W/mm^2
  QG_REF(Vec3s) unscattered;  // the same
  QG_REF(Floats) sky;  // per face of level 0: share of uniform illumination from outside that the body does not hide
  QG_REF(LightRecords) lights;
  QG_REF(LightShapes) shapes;  // per light
  QG_REF(ShadowViews) views;
  QG_REF(Uints) triangles;      // of the display mesh: three display vertices each
  QG_REF(Uints) triangle_face;  // per display triangle: outside face of level 0
  QG_REF(GatherPoints) points;
  QG_REF(GatherScales) scale;
  QG_REF(SurfaceShares) share;                // per surface vertex of level 0; null: errors are not told by part
  QG_REF(Opticals) elsewhere[DOUBT_SAMPLES];  // per tet: the material at other places in it; null: it changes in none
  SolidRef solid;
  RoughnessMapRef roughness_map;
  NormalMapRef normal_map;
};

#ifndef __cplusplus
QG_ARRAY(SurfaceScenes, SurfaceScene);

#endif

// visibility.vert: which triangle of the display mesh is seen at a sample.
struct VisibilityPush {
  QG_REF(SurfaceScenes) scene;  // one
};

// What a pixel's scattered radiance is off by, as far as gather.comp can tell (engine/render/picture/picture_error.h).
struct PixelDoubt {
  float unlit, dimmest;  // shares of the pixel that are of these parts of the surface
  float angle;           // W/(mm^2 sr), channels together: what the radiance is more than that of a diffuser
  float covered;         // share of the pixel that the body covers, without the ground
  float medium;  // W/(mm^2 sr), channels together: what it is more with the material of elsewhere, one pixel of four
};
#ifndef __cplusplus
QG_ARRAY(PixelDoubts, PixelDoubt);

#endif

// Layers of a picture: scattered, specular and unscattered radiance, and transmittance.
#define PICTURE_LAYERS 4
// Images of samples that surface_path.frag and false_colour.frag draw: scattered radiance and coverage, specular,
// unscattered.
#define SAMPLE_LAYERS 3

// Of each pixel that the silhouette may cross, places at which it is told whether the body covers them.
const uint COVERAGE_WORDS = 4u;
const uint COVERAGE_PLACES = 32u * COVERAGE_WORDS;

struct PixelCoverage {
  uint covered[COVERAGE_WORDS];  // bits by place
  uint triangle;                 // 1 + the last display triangle that covers any; 0: none does
};
#ifndef __cplusplus
QG_ARRAY(PixelCoverages, PixelCoverage);

#endif

// Words of 32 bits for a row of a tile, a bit for each pixel.
QG_INLINE uint silhouette_words(uint width) {
  return (width + 31u) / 32u;
}

// Which pixels of a picture those of a tile are, and where their 2 x 2 samples.
struct TilePixels {
  uint left;   // column of its first pixel in the picture
  uint top;    // and row
  uint width;  // pixels of the tile inside the picture
  uint height;
  uint sample_stride;  // samples in a row of the tile
  uint picture_width;  // pixels
  uint picture_height;
};

// resolve.comp: 2 x 2 samples of each pixel of a tile into the picture.
struct ResolvePush {
  QG_REF(Vec4s) samples[SAMPLE_LAYERS];
  QG_REF(Floats) layers[PICTURE_LAYERS];  // RGB per pixel, written
  QG_REF(Floats) alpha;                   // per pixel, written
  TilePixels tile;
};

// shading.comp, gather.comp: what the 2 x 2 samples of each pixel of a tile show, into the picture.
struct ShadePush {
  QG_REF(SurfaceScenes) scene;            // one
  QG_REF(Uints) seen;                     // per sample: 1 + the display triangle, 0: none
  QG_REF(Uints) marked;                   // pixels of which coverage is told, as silhouette.comp leaves them
  QG_REF(PixelCoverages) coverage;        // per pixel of the tile
  QG_REF(Floats) layers[PICTURE_LAYERS];  // RGB per pixel, written
  QG_REF(Floats) alpha;                   // per pixel, written
  QG_REF(PixelDoubts) doubt;              // the same, by gather.comp; null: not wanted
  TilePixels tile;
  uint frame;          // of those that make the picture
  uint facets;         // of a rough surface, for each view ray through a clear body
  uint edge_facets;    // the same through any body where the pixel is covered in part
  float transmission;  // GGX alpha of the surface for light that comes through; below 0: its own
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
