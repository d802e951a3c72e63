// Integrals over a tet by Gauss points along each of three collapsed edges [Stroud 1971]; shared with C++, see
// shared.h.
#ifndef QUADGRAPH_TET_QUADRATURE_H
#define QUADGRAPH_TET_QUADRATURE_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Nodes and weights on 0 to 1: two from GAUSS_TWO on, and so on.
const uint GAUSS_TWO = 0u;
const uint GAUSS_THREE = 2u;
const uint GAUSS_FOUR = 5u;
const uint GAUSS_FIVE = 9u;
const float GAUSS_NODE[14] = {0.2113248654f, 0.7886751346f, 0.1127016654f, 0.5f,          0.8872983346f,
                              0.0694318442f, 0.3300094782f, 0.6699905218f, 0.9305681558f, 0.0469100770f,
                              0.2307653449f, 0.5f,          0.7692346551f, 0.9530899230f};
const float GAUSS_WEIGHT[14] = {0.5f,          0.5f,          0.2777777778f, 0.4444444444f, 0.2777777778f,
                                0.1739274226f, 0.3260725774f, 0.3260725774f, 0.1739274226f, 0.1184634425f,
                                0.2393143352f, 0.2844444444f, 0.2393143352f, 0.1184634425f};

// Optical lengths of an edge up to which as many points integrate exp(-depth) to half a per cent; five, to twice that.
const float GAUSS_TWO_UP_TO = 2.0f;
const float GAUSS_THREE_UP_TO = 5.0f;
const float GAUSS_FOUR_UP_TO = 9.0f;

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
