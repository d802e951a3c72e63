// Types of the passes that light the cells of the shortest-path method and show them, in scalar layout;
// see shared.h.
#ifndef QUADGRAPH_PATH_LIGHT_SHARED_H
#define QUADGRAPH_PATH_LIGHT_SHARED_H

#include "light/render_shared.h"
#include "path/path_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// path_enter.comp: what enters the cells that the surface crosses: of all points where it crosses the lines through
// their middles, the most, per channel.
struct PathEnterPush {
  PathGrid grid;
  uint triangle_count;
  QG_REF(Vec3s) vertices;  // mm
  QG_REF(Uvec3s) triangles;
  QG_REF(Uints) flags;
  QG_REF(Uints) entering;  // PathStartPush; begun at 0
  QG_REF(LightRecords) lights;
  QG_REF(LightShapes) shapes;  // per light
  QG_REF(ShadowViews) views;
  uint stripes;  // invocations per triangle and axis
  uint light_count;
  float eta, coat_eta, coat;    // as of OpticalSurface
  float diffuse_transmittance;  // of a smooth surface under uniform illumination from outside
  PathTools tools;  // where there are any, cells hide the light and not shadow maps, which know nothing of them
};

// path_enter_cut.comp takes the push above: what enters the cells beside what is cut away.

// surface_path.vert, surface_path.frag: radiance of the display mesh, from the cells.
struct SurfacePathPush {
  QG_REF(SurfaceScenes) scene;  // one
  QG_REF(PathFields) field;     // one
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
