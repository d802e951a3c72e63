// A place's coefficients after edits, one after the other.
#ifndef QUADGRAPH_EDITS_GLSL
#define QUADGRAPH_EDITS_GLSL

#include "material/edits.h"

struct AllEdits {
  MaterialEdits edits;
  Vec3s points;   // mm, of all strokes
  Vec3s texels;   // of all images
  uint count;
  float spacing;  // mm, of the places that are evaluated: what is finer in an image is taken together
};

float stroke_distance(Vec3s points, MaterialEdit e, vec3 position) {
  float nearest = 1e30;
  vec3 from = points.at[e.first_point];
  for (uint k = 0u; k < e.point_count; ++k) {
    vec3 to = points.at[e.first_point + k];
    nearest = min(nearest, segment_distance(position, from, to));
    from = to;
  }
  return nearest;
}

Optical placed(AllEdits those, Optical optical, MaterialEdit e, vec3 position, float weight) {
  vec3 factor = vec3(1);
  if (e.placed == 1u) {
    vec3 place = in_box(e.box, position);
    vec2 at = in_picture(e.box, place);
    weight *= box_weight(e, place);
    if (weight == 0.0) return optical;
    if (e.image.levels > 0u) {
      factor = load_image(those.texels, image_tap(e.image, at, texels_across(e.box, e.image, those.spacing)));
    }
    if (e.mask.levels > 0u) {
      ImageTap tap = image_tap(e.mask, at, texels_across(e.box, e.mask, those.spacing));
      weight *= min(luminance(load_image(those.texels, tap)), 1.0);
    }
  }
  return edited(optical, e, factor, weight);
}

// At a place, mm, at rest, `depth` mm below the surface.
Optical edited_at(AllEdits those, Optical optical, vec3 position, float depth) {
  for (uint k = 0u; k < those.count; ++k) {
    MaterialEdit e = those.edits.at[k];
    bool here = e.point_count == 0u || (all(greaterThan(position, e.low)) && all(lessThan(position, e.high)));
    if (!here) continue;
    float distance = e.point_count > 0u ? stroke_distance(those.points, e, position) : 0.0;
    optical = placed(those, optical, e, position, edit_weight(e, distance, depth));
  }
  return optical;
}

#endif
