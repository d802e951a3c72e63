#version 460
#extension GL_GOOGLE_include_directive : require
#include "edits.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { EditMaterialPush push; };

float stroke_distance(MaterialEdit e, vec3 position) {
  float nearest = 1e30;
  vec3 from = load_vec3(push.points, e.first_point);
  for (uint k = 0u; k < e.point_count; ++k) {
    vec3 to = load_vec3(push.points, e.first_point + k);
    nearest = min(nearest, segment_distance(position, from, to));
    from = to;
  }
  return nearest;
}

Optical placed(Optical optical, MaterialEdit e, vec3 position, float weight) {
  vec3 factor = vec3(1);
  if (e.placed == 1u) {
    vec3 place = in_box(e.box, position);
    vec2 at = in_picture(e.box, place);
    weight *= box_weight(e, place);
    if (weight == 0.0) return optical;
    if (e.image.levels > 0u) {
      factor = load_image(push.texels, image_tap(e.image, at, texels_across(e.box, e.image, push.spacing)));
    }
    if (e.mask.levels > 0u) {
      ImageTap tap = image_tap(e.mask, at, texels_across(e.box, e.mask, push.spacing));
      weight *= min(luminance(load_image(push.texels, tap)), 1.0);
    }
  }
  return edited(optical, e, factor, weight);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Optical optical = push.base.at[i];
  vec3 position = push.edit_count > 0u ? load_vec3(push.nodes, i) : vec3(0);
  float depth = push.with_depth == 1u ? load_float(push.depth, i) : 0.0;
  for (uint k = 0u; k < push.edit_count; ++k) {
    MaterialEdit e = push.edits.at[k];
    bool here = e.point_count == 0u || (all(greaterThan(position, e.low)) && all(lessThan(position, e.high)));
    if (!here) continue;
    float distance = e.point_count > 0u ? stroke_distance(e, position) : 0.0;
    optical = placed(optical, e, position, edit_weight(e, distance, depth));
  }
  push.optical.at[i] = optical;
}
