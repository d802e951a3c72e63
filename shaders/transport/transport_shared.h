// What the passes of the transport correction share with C++, in scalar layout; see shared.h. Equations:
// docs/physics.md, "Transport correction". All light is in units of the scale.
#ifndef QUADGRAPH_TRANSPORT_SHARED_H
#define QUADGRAPH_TRANSPORT_SHARED_H

#include "shared/body_shared.h"
#include "shared/forward_scattering.h"
#include "solver/solve_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Samples come in two halves, each an estimate of its own: what both agree on is no noise.
const uint TRANSPORT_HALVES = 2u;

// What a point stands for falls with the mean free paths d below the surface, as e^-d + TRANSPORT_FLOOR: deep light
// matters to what leaves in thick bodies alone, but there it does.
const float TRANSPORT_FLOOR = 0.03f;

// Of bodies that share a surface, the most points for each mm^3 in one, times those in what is around it, and the
// least.
const float TRANSPORT_DENSER = 16.0f;

// A ray that keeps less than this goes on by chance, with this weight.
const float TRANSPORT_ROULETTE = 0.3f;

// Sums of the walk of the light (transport_walk.comp).
const uint TRANSPORT_WALK_SUMS = 4u;

// Sums of the walks that certify a solution (certify.comp), and steps, through a tet or to a collision, after which one
// is given up.
const uint CERTIFY_SUMS = 3u;
const uint CERTIFY_STEPS = 1048576u;

// Parts of the body that a ray can meet in the air, one after the other, before it is given up.
const uint TRANSPORT_MEETINGS = 8u;

// Light that a tet scatters, at its corners, W/mm^3, in one line of a cache: the last number of each is not used.
struct TetSource {
  vec4 source_0, source_1, source_2, source_3;
};

// Where the transport equation is evaluated inside the body.
struct TransportPoint {
  uint tet;
  uint number;   // of those in this tet and half
  uint half_of;  // the half that it counts for
  float volume;  // mm^3 that it stands for
};

#ifndef __cplusplus
QG_ARRAY(TetSources, TetSource);

#endif

// What a tet that scatters forwards has for rays, by channel, W/mm^3: at each of its corners what goes along x, y and
// z, whose sum by a direction of travel comes on top of the source; at each what it scatters for the first time; and
// the mean direction of that light, along x, y and z, at most of length 1.
const uint FLOWS = 19u;
const uint FLOWS_FIRST = 12u;
const uint FLOWS_DIRECTION = 16u;

// What rays see: the body, and the light that it scatters. Where the coefficients have changed, also the field before,
// with those that it had: the same rays see both.
struct TransportFieldRef {
  BodyRef body;
  TreeRef tree;
  QG_REF(TetSources) sources;   // per tet
  QG_REF(Floats) sky;           // per face: share of all directions outside in which no other part of the body is
  QG_REF(Uints) segments;       // tets crossed by all rays so far, one
  QG_REF(Vec3s) source_before;  // light that the field before scatters, four per tet, W/mm^3; or null
  QG_REF(Opticals) optical_before;
  QG_REF(Vec3s) flows;  // FLOWS per tet, where light scatters forwards; or null
  BesidePeak beside;    // the same
  uint even_before;     // 1: optical_before is the same everywhere
  uint outside;         // 1: light that leaves may enter again elsewhere
};

// What the passes of light that scatters forwards have in common (forward_scattering.h).
struct TransportForwardRef {
  QG_REF(Vec3s) vertices;
  QG_REF(Uvec4s) tets;
  QG_REF(Opticals) optical;  // of transport_optical.comp: per tet, or one
  QG_REF(Floats) etendue;    // as of BodyRef
  QG_REF(Uints) tet_offset;  // tets around each vertex
  QG_REF(Uints) tet_incidence;
  QG_REF(Uints) deposit;  // fixed point, at the corners of the tets, four each: power scattered for the first time
  QG_REF(Uints) towards;  // fixed point, three per tet: that times half of 1 and the direction of travel
  BesidePeak beside;
  uint vertex_count;
  uint tet_count;
  uint even;  // 1: optical is the same everywhere
};

// Where the power of a sweep goes, W, scaled.
struct TransportBook {
  vec3 first, absorbed;          // of the field: scattered for the first time, and absorbed of its fluence
  vec3 lost;                     // of its fluence by extinction
  vec3 leaving_a, leaving_b;     // transport_leaving.comp, of each half
  vec3 sum_a, sum_b;             // of all that points are to find, of each half
  vec3 known_a, known_b;         // that of the sweep before
  vec3 known_left, known_again;  // the same of `left` and `again`
  vec3 missing_a, missing_b;     // in what the points found, as a share of what is lost
  vec3 left, again;              // gathered of both halves together, and what of that enters again
  vec3 gain;                     // of what a solve adds: what of that leaves enters again, and so on
};

// Area-weighted squares over the whole surface (x), over its unlit part (y) and over its dimmest third (z), channels
// together.
struct TransportChange {
  vec3 change;  // product of what both halves have changed the exitance by: without their noise
  vec3 noise;   // of half the difference between the halves
  vec3 size;    // of the exitance
};

#ifndef __cplusplus
QG_ARRAY(TransportFieldRefs, TransportFieldRef);
QG_ARRAY(TransportForwardRefs, TransportForwardRef);
QG_ARRAY(TransportBooks, TransportBook);
QG_ARRAY(TransportChanges, TransportChange);
QG_ARRAY(TransportPoints, TransportPoint);

#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
