// Light as the solve takes it in, beam by beam; shared with C++, see shared.h.
#ifndef QUADGRAPH_BEAM_SHARED_H
#define QUADGRAPH_BEAM_SHARED_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

const uint BEAM_DIRECTIONAL = 0u;
const uint BEAM_POINT = 1u;
const uint BEAM_LAMBERTIAN = 2u;
const uint BEAM_MEAN = 3u;
const uint BEAM_RECTANGLE = 4u;

// How the light of one source comes in, wherever it does.
struct BeamRecord {
  uint kind;            // BEAM_*
  vec3 travel_or_from;  // directional: unit, the way the light travels; point: where it comes from, mm; rectangle: its
                        // centre, mm; environment: unit, to the middle of its picture; others: unused
  vec3 u, v;            // rectangle: its edges, mm; environment: unit, right and up in its picture; others: unused
};

// How much of a beam is stored per face, floats: one, one per quarter or three per quarter, to be multiplied by its
// colour; or q itself, for the whole face.
const uint BEAM_FACE = 1u;
const uint BEAM_QUARTERS = FACE_QUARTERS;
const uint BEAM_RGB = 3u;
const uint BEAM_RGB_QUARTERS = 3u * FACE_QUARTERS;

// A beam as the faces of all levels see it (beam_light.glsl).
struct Beam {
  BeamRecord way;
  vec3 colour;            // W/mm^2 of what is stored as 1; environment: W/(mm^2 sr) of what is 1 in its picture
  uint floats;            // BEAM_FACE, BEAM_QUARTERS, BEAM_RGB or BEAM_RGB_QUARTERS
  uint offset;            // floats of the beams before it, per face
  QG_REF(Vec3s) picture;  // of an environment (environment_picture.h), else null
};

// Rays of a Lambertian beam from one origin: at outside cosine sqrt(u), u the four Gauss-Legendre nodes on [0, 1], two
// antipodal azimuths each, turned by 90 degrees from node to node so that no direction is preferred. Each node has
// weight w T(sqrt(u)), T the Fresnel transmittance, normalised to 1.
const uint LAMBERTIAN_NODES = 4u;
const float LAMBERTIAN_U[4] = {0.0694318442f, 0.3300094782f, 0.6699905218f, 0.9305681558f};
const float LAMBERTIAN_W[4] = {0.1739274226f, 0.3260725774f, 0.3260725774f, 0.1739274226f};

// BEAM_MEAN is uniform illumination by one ray from an origin, at the mean inside cosine of those of a Lambertian beam:
// for light that re-enters, bounce after bounce. On face f it has the azimuth (f GOLDEN_TURN mod 2^32) / 2^32 turns,
// from the face's first edge t1 towards normal x t1. The golden ratio's fraction in units of 2^-32: integers turn alike
// on CPU and GPU.
const uint GOLDEN_TURN = 2654435769u;

// A ray of a rectangle comes from a place in one of so many parts along each edge, all of the same size, a part being
// drawn by what it lets into the surface. It takes the numbers 0 to 2 of the spread sequence: in the source walk those
// at four times the face's number and its quarter's.
const uint RECTANGLE_SIDE = 4u;

#ifndef __cplusplus
QG_ARRAY(Beams, Beam);

#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
