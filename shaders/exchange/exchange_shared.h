// What the passes that take light from part to part share with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_EXCHANGE_SHARED_H
#define QUADGRAPH_EXCHANGE_SHARED_H

#include "shared/body_shared.h"
#include "surface/surface_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

struct ExchangeState {
  vec3 power;    // W, that enters again
  vec3 change;   // W, integral of the difference to what entered again before, without its sign
  vec3 entered;  // W, of the scene's light
};

#ifndef __cplusplus
QG_ARRAY(ExchangeStates, ExchangeState);
#endif

// exchange.comp: irradiance of every face from those its rays met, each of which sends M and reflects part of what it
// received before; and the factor with which all arrives that is sent towards other faces.
struct ExchangePush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_kinds;
  QG_REF(Uvec2s) rows;  // per face: its entries are entry[rows.x] to entry[rows.y - 1]
  QG_REF(Uints) entries;
  QG_REF(Vec3s) exitance;  // without the factor of the clip
  QG_REF(Clips) clip;
  QG_REF(Vec3s) before;      // irradiance of the bounce before
  QG_REF(Vec3s) irradiance;  // written, without the factor
  QG_REF(Vec3s) factor;      // one, written
  QG_REF(ExchangeStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  float rays;         // per face
  float transmitted;  // share of even light
};

// exchange_finer.comp: irradiance of a level from the next coarser one, and the factor that keeps its power.
struct ExchangeFinerPush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) face_kinds;
  QG_REF(Uints) index;
  QG_REF(Floats) weight;
  QG_REF(Vec3s) coarse;      // irradiance
  QG_REF(Vec3s) irradiance;  // written, without the factor
  QG_REF(Vec3s) factor;      // one, written
  QG_REF(ExchangeStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  uint width;
  float transmitted;  // share of even light
};

// exchange_enter.comp: multiplies the irradiance by the factor; what of it enters becomes a beam.
struct ExchangeEnterPush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Vec3s) q;  // W/mm^2, of the scene's light
  QG_REF(Vec3s) irradiance;
  QG_REF(Vec3s) beam_q;  // of that beam, written
  QG_REF(Vec3s) factor;  // one
  QG_REF(ExchangeStates) state;
  QG_REF(Reduction) reduction;
  uint count;
  float transmitted;  // share of even light
};

// exchange_boxes.comp: boxes of the nodes `first` to `first` + `count` - 1 of the tree, leaves before their parents.
struct ExchangeBoxesPush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) order;
  QG_REF(Uints) leaf_begin;
  QG_REF(Boxes) boxes;  // by node
  uint first;
  uint count;
  uint leaf_count;
};

// exchange_rays.comp: rows of the faces `first` to `first` + `count` - 1 modulo `face_count`, one workgroup each, of at
// most `rays` entries from face * rays on.
struct ExchangeRaysPush {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec3s) faces;
  QG_REF(Uints) order;
  QG_REF(Uints) leaf_begin;
  QG_REF(Boxes) boxes;
  QG_REF(Uvec2s) rows;    // written
  QG_REF(Uints) entries;  // written
  uint first;
  uint face_count;
  uint leaf_count;
  uint rays;
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
