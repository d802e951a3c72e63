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

bool in_bounds(vec3 position, uint point_count, vec3 low, vec3 high) {
  return point_count == 0u || (all(greaterThan(position, low)) && all(lessThan(position, high)));
}

EditReach reach_at(AllEdits those, MaterialEdit e, EditPlace where, vec3 position, float depth) {
  EditReach reach;
  reach.factor = vec3(1);
  float distance = where.point_count > 0u ? stroke_distance(those.points, where, position) : 0.0;
  reach.weight = edit_weight(e, where, distance, depth);
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

// After edit k, where its own strokes are near (`here`), or their mirror images (`there`).
Optical after_edit(AllEdits those, uint k, Optical optical, vec3 position, float depth, bool here, bool there) {
  MaterialEdit e = those.edits.at[k];
  EditReach reach;
  reach.factor = vec3(1);
  reach.weight = 0.0;
  if (here) reach = reach_at(those, e, e.place, position, depth);
  if (there) {
    EditReach other = reach_at(those, e, e.mirror, position, depth);
    if (other.weight > reach.weight) reach = other;
  }
  return edited(optical, e, reach);
}

// At a place, mm, at rest, `depth` mm below the surface. Of edits that are far only the bounds are loaded.
Optical edited_at(AllEdits those, Optical optical, vec3 position, float depth) {
  Optical below = optical;
  for (uint k = 0u; k < those.count; ++k) {
    bool here = in_bounds(position, those.edits.at[k].place.point_count, those.edits.at[k].place.low,
                          those.edits.at[k].place.high);
    bool there = those.edits.at[k].mirrored == 1u &&
                 in_bounds(position, those.edits.at[k].mirror.point_count, those.edits.at[k].mirror.low,
                           those.edits.at[k].mirror.high);
    if (those.edits.at[k].joins == 0u) below = optical;
    if (here || there) optical = after_edit(those, k, optical, position, depth, here, there);
    if (those.edits.at[k].opacity < 1.0) optical = mixed(below, optical, those.edits.at[k].opacity);
  }
  return optical;
}

#endif
