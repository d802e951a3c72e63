// What the passes of inter-reflection share with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_EXCHANGE_SHARED_H
#define QUADGRAPH_EXCHANGE_SHARED_H

#include "shared/body_shared.h"
#include "surface/surface_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

struct ExchangeState {
  vec3 power;        // W, that enters again
  vec3 transmitted;  // the share of what arrives that it is
  vec3 change;       // W, integral of the difference to what entered again before, without its sign
  vec3 entered;      // W, of the scene's light
};

#ifndef __cplusplus
QG_ARRAY(ExchangeStates, ExchangeState);
#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
