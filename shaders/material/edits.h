// Edits of a material field, applied by the same code on the GPU and in the CPU reference; see shared.h.
#ifndef QUADGRAPH_EDITS_H
#define QUADGRAPH_EDITS_H

#include "material/optics.h"
#include "shared/image_levels.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::clamp;
using glm::sqrt;
#endif

const uint EDIT_MULTIPLY = 0u;  // coefficient times the edit's
const uint EDIT_ADD = 1u;       // plus it, not below 0
const uint EDIT_SET = 2u;       // becomes it
// Which coefficients it changes.
const uint EDIT_SCATTERING = 1u;
const uint EDIT_ABSORPTION = 2u;

// Where an edit is: its stroke and its box.
struct EditPlace {
  vec3 low;          // mm, box of the places that the stroke reaches, with point_count > 0
  vec3 high;         // mm
  uint first_point;  // of the stroke
  uint point_count;  // 0: everywhere
  uint placed;       // 1: only in the box
  ImageBox box;
};

// One edit: what it does, and where; engine/optics/edit.h says it in a user's words.
struct MaterialEdit {
  // What is looked at for every place comes first.
  float opacity;  // how much is left in the end of what it does, together with those before that it joins
  uint joins;     // 1: the edit before, and those that this joins
  uint mirrored;  // 1: also at `mirror`; a place gets what is more
  EditPlace place;
  EditPlace mirror;
  vec3 sigma_s_prime;
  vec3 sigma_a;
  float depth_from;  // mm below the surface
  float depth_to;    // mm
  float radius;      // mm around the stroke
  float softness;    // mm over which it fades at its bounds
  uint operation;    // EDIT_MULTIPLY, EDIT_ADD, EDIT_SET
  uint coefficients;
  ImageLevels image;  // in the box: what the coefficients above are multiplied by
  ImageLevels mask;   // in the box: the luminance is how much of the edit arrives
};

// What an edit does at a place.
struct EditReach {
  vec3 factor;   // of its image
  float weight;  // how much of it arrives, 0 to 1
};

QG_INLINE float segment_distance(vec3 p, vec3 a, vec3 b) {
  vec3 ab = b - a;
  float t = clamp(dot(p - a, ab) / max(dot(ab, ab), 1e-20f), 0.0f, 1.0f);
  vec3 away = p - a - t * ab;
  return sqrt(dot(away, away));
}

// 1 where x is well below 0, 0 where it is well above, in between over `softness`.
QG_INLINE float inside(float x, float softness) {
  float t = clamp(0.5f - x / max(softness, 1e-6f), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

// How much of an edit arrives at `distance` from its stroke at `where`, mm, `depth` below the surface, mm; 0 to 1.
QG_INLINE float edit_weight(MaterialEdit e, EditPlace where, float distance, float depth) {
  float weight = inside(depth - e.depth_to, e.softness);
  if (e.depth_from > 0.0f) weight *= inside(e.depth_from - depth, e.softness);
  if (where.point_count > 0u) weight *= inside(distance - e.radius, e.softness);
  return weight;
}

// Weight of a box at `place` in it (in_box).
QG_INLINE float box_weight(ImageBox box, vec3 place, float softness) {
  vec3 over = max(place, -place) - box.half_size;
  return inside(max(over.x, max(over.y, over.z)), softness);
}

QG_INLINE vec3 edited_coefficient(uint operation, vec3 value, vec3 by, float weight) {
  vec3 edited = mix(value, by, weight);
  if (operation == EDIT_MULTIPLY) edited = value * mix(vec3(1.0f), by, weight);
  if (operation == EDIT_ADD) edited = value + weight * by;
  return clamp(edited, vec3(0.0f), vec3(COEFFICIENT_MAX));
}

QG_INLINE Optical edited(Optical optical, MaterialEdit e, EditReach reach) {
  if ((e.coefficients & EDIT_SCATTERING) != 0u) {
    vec3 by = reach.factor * e.sigma_s_prime;
    optical.sigma_s_prime = edited_coefficient(e.operation, optical.sigma_s_prime, by, reach.weight);
  }
  if ((e.coefficients & EDIT_ABSORPTION) != 0u) {
    optical.sigma_a = edited_coefficient(e.operation, optical.sigma_a, reach.factor * e.sigma_a, reach.weight);
  }
  return optical;
}

#ifndef __cplusplus
QG_ARRAY(MaterialEdits, MaterialEdit);
#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
