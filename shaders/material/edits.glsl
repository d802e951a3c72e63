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

float stroke_distance(Vec3s points, EditPlace where, vec3 position) {
  float nearest = 1e30;
  vec3 from = points.at[where.first_point];
  for (uint k = 0u; k < where.point_count; ++k) {
    vec3 to = points.at[where.first_point + k];
    nearest = min(nearest, segment_distance(position, from, to));
    from = to;
  }
  return nearest;
}

EditReach reach_at(AllEdits those, MaterialEdit e, EditPlace where, vec3 position, float depth) {
  EditReach reach;
  reach.factor = vec3(1);
  reach.weight = 0.0;
  bool strokes = where.point_count > 0u;
  if (strokes && !(all(greaterThan(position, where.low)) && all(lessThan(position, where.high)))) return reach;
  reach.weight = edit_weight(e, where, strokes ? stroke_distance(those.points, where, position) : 0.0, depth);
  if (where.placed == 0u) return reach;
  vec3 place = in_box(where.box, position);
  vec2 at = in_picture(where.box, place);
  reach.weight *= box_weight(where.box, place, e.softness);
  if (reach.weight == 0.0) return reach;
  if (e.image.levels > 0u) {
    ImageTap tap = image_tap(e.image, at, texels_across(where.box, e.image, those.spacing));
    reach.factor = load_image(those.texels, tap);
  }
  if (e.mask.levels > 0u) {
    ImageTap tap = image_tap(e.mask, at, texels_across(where.box, e.mask, those.spacing));
    reach.weight *= min(luminance(load_image(those.texels, tap)), 1.0);
  }
  return reach;
}

// At a place, mm, at rest, `depth` mm below the surface.
Optical edited_at(AllEdits those, Optical optical, vec3 position, float depth) {
  Optical below = optical;
  for (uint k = 0u; k < those.count; ++k) {
    MaterialEdit e = those.edits.at[k];
    if (e.joins == 0u) below = optical;
    EditReach reach = reach_at(those, e, e.place, position, depth);
    if (e.mirrored == 1u) {
      EditReach other = reach_at(those, e, e.mirror, position, depth);
      if (other.weight > reach.weight) reach = other;
    }
    if (reach.weight > 0.0) optical = edited(optical, e, reach);
    if (e.opacity < 1.0) optical = mixed(below, optical, e.opacity);
  }
  return optical;
}

#endif
