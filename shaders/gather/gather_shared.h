// What the passes of gathered radiance share with C++, in scalar layout; see shared.h. Equations: docs/accuracy.md.
#ifndef QUADGRAPH_GATHER_SHARED_H
#define QUADGRAPH_GATHER_SHARED_H

#include "shared/body_shared.h"
#include "solver/solve_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Light at a vertex, in one line of a cache: the last number of each is not used. All are linear between vertices;
// uncollided fluence is entry exp(-depth), which is exact for a beam behind a flat face, but held to what is linear
// between vertices (gather_fields.glsl).
struct GatherPoint {
  vec4 phi;         // W/mm^2, basic fluence (engine/solve/etendue.h) of light that has scattered
  vec4 entry;       // W/mm^2, fluence of light that has not, as if nothing had been lost on its way
  vec4 depth;       // optical depth of that way
  vec4 uncollided;  // W/mm^2, entry exp(-depth)
};

// At a surface vertex: radiance is `factor` times what is gathered, and a Lambertian exitance `rest`, but at least that
// of a Lambertian exitance `least`.
struct GatherScale {
  vec3 factor;
  vec3 rest;   // W/mm^2
  vec3 least;  // W/mm^2
};

// Sums over the open faces below a node of the tree over a body's faces, or one of these.
struct GatherNode {
  vec3 exitance;  // W, of the solve
  vec3 gathered;  // W, of what is gathered
  vec3 normal;    // mm^2, area times normal
  vec3 place;     // mm^3, area times centroid
  float area;     // mm^2
};

// The solve's exitance follows the surface less closely than light does: within a mean free path the shape is that of
// what is gathered. The factor of a vertex is therefore a ratio of means, with weights
//   (exp(-d^2 / (2 s^2)) - end) (1 + n n') / 2 alike,   s^2 = GATHER_PATH / sigma_t^2 + GATHER_EDGE mean squared edge,
// at distance d, where `end` brings them to zero at GATHER_REACH s, and `alike`, the smaller over the larger of what is
// gathered here and there but at least GATHER_ALIKE, keeps bright faces from speaking for dark ones. Nodes whose
// diagonal is at most GATHER_NODE s are taken whole. A centroid is at most sqrt(2/3) of a face's root mean squared edge
// away from a corner: GATHER_EDGE GATHER_REACH^2 > 2/3 leaves no vertex without a face.
const float GATHER_PATH = 1.4f;
const float GATHER_EDGE = 0.12f;
const float GATHER_REACH = 2.4f;
const float GATHER_ALIKE = 1e-3f;
const float GATHER_NODE = 1.0f;
// The largest factor: where the fluence of a coarse mesh is far too low, gathering has nothing to scale.
const float GATHER_FACTOR_MAX = 4.0f;
// What of the exitance, as a diffuser would send it, radiance is at least where edges are GATHER_LONG mean free paths
// or longer; nothing where they are half as long. Beside an edge between light and shadow the fluence of long elements
// undershoots, and what is gathered there can be nothing or less.
const float GATHER_FLOOR = 0.4f;
const float GATHER_LONG = 4.0f;
// A view ray ends where every channel keeps at most GATHER_END, and what lies behind, if it is as bright as the last
// tet, adds at most GATHER_END to what is gathered; or keeps at most GATHER_LEAST. What lies behind then counts as
// even. Seen from the unlit side the fluence grows inwards almost as fast as it is attenuated: the first condition
// alone loses 5%.
const float GATHER_END = 1e-2f;
const float GATHER_LEAST = 1e-6f;
// Tets that a view ray crosses at most.
const uint GATHER_STEPS = 1024u;
// From this share on all of a branch is followed through further parts of a body, below GATHER_END nothing.
const float FOLLOWED_WHOLE = 5e-2f;
// Parts of a body that a view ray and its branches go through at most.
const uint VIEW_PARTS = 8u;
// Optical depth from which on light that has not scattered counts as none, and tets on the way back to where it
// entered.
const float UNCOLLIDED_DEPTH = 16.0f;
const uint UNCOLLIDED_STEPS = 512u;
// Of the light of several beams only entry exp(-depth) is known; between vertices the entry is linear. A beam counts in
// it by exp(-depth / SHARED_DEPTH), against the one that counts most, and not at all from UNCOLLIDED_DEPTH on: where a
// bright one comes to its end, or is not there any more, the entry does not change at once from one vertex to the next.
const float SHARED_DEPTH = 3.0f;
// Least inside cosine of light at the face where it enters.
const float LEAST_COSINE = 0.02f;
// A refracted view ray keeps at least this cosine with the face that it enters, whose normal is not that of the
// display.
const float LEAST_VIEW_COSINE = 0.02f;

#ifndef __cplusplus
QG_ARRAY(GatherPoints, GatherPoint);
QG_ARRAY(GatherScales, GatherScale);
QG_ARRAY(GatherNodes, GatherNode);

#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
