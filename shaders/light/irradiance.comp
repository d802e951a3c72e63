#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/lights.glsl"
#include "material/fresnel.glsl"
#include "light/environment.glsl"
#include "light/shaped.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// q of every outside face of a level, the mean over the face, and what each light brings to its
// quarters.
struct IrradiancePush {
  Vec3s vertices;  // mm
  Uvec3s faces;
  Uints face_kinds;
  Vec3s q;        // W/mm^2, written
  Floats beam_q;  // per beam what gpu::Beam says: shares of its power; written
  Floats sky;     // per face: share of ambient light that other parts of the body do not hide
  Vec3s hidden;   // per environment and face: what they hide of it, as q; null: by the share of the sky
  LightRecords lights;
  LightShapes shapes;  // per light
  ShadowViews views;
  uint face_count;
  uint light_count;
  uint subdivision;  // even: the face is sampled at the centroids of subdivision^2 equal triangles
};
layout(push_constant, scalar) uniform Block { IrradiancePush push; };
#define ENTERED push
#include "light/entering.glsl"

// The quarter of a face that its point a + u ab + v ac lies in, away from their boundaries.
uint quarter_of(float u, float v) {
  return u + v < 0.5 ? 0u : u > 0.5 ? 1u : v > 0.5 ? 2u : 3u;
}

// What enters a face of a directional light where nothing hides it, and where the face lies in the light's map, which is
// linear in places on the face.
struct LitFace {
  float share;
  ShadowView view;
  ShadowPlace corner, ab, ac;  // at a, and how far from there at a + ab and a + ac
};

ShadowPlace apart(ShadowPlace from, ShadowPlace to) {
  return ShadowPlace(to.texel - from.texel, to.depth - from.depth);
}

LitFace lit_face(Lamp lamp, vec3 a, vec3 ab, vec3 ac, vec3 normal) {
  LitFace face;
  face.share = share_from(lamp, a, normal);
  if (face.share <= 0.0) return face;
  face.view = push.views.at[lamp.light.first_view];
  face.corner = shadow_place(face.view, false, a, normal);
  face.ab = apart(face.corner, shadow_place(face.view, false, a + ab, normal));
  face.ac = apart(face.corner, shadow_place(face.view, false, a + ac, normal));
#ifdef QG_PROCESSOR
  vec2 ab_end = face.corner.texel + face.ab.texel, ac_end = face.corner.texel + face.ac.texel;
  fetch_between(face.view, min(min(ab_end, ac_end), face.corner.texel), max(max(ab_end, ac_end), face.corner.texel));
#endif
  return face;
}

float lit_share(LitFace face, float u, float v) {
  vec2 texel = face.corner.texel + u * face.ab.texel + v * face.ac.texel;
  float depth = face.corner.depth + u * face.ab.depth + v * face.ac.depth;
  return filtered(face.view, ShadowPlace(texel, depth), 0);
}

// Irradiance on the four quarters of the face a, a + ab, a + ac.
vec4 quarters_of(Lamp lamp, vec3 a, vec3 ab, vec3 ac, vec3 normal) {
  vec4 quarter = vec4(0);
  bool directional = lamp.light.kind == LIGHT_DIRECTIONAL;
  float weight = float(FACE_QUARTERS) / float(push.subdivision * push.subdivision);
  LitFace face;
  if (directional) {
    face = lit_face(lamp, a, ab, ac, normal);
    if (face.share <= 0.0) return quarter;
    weight *= face.share;
  }
  uint n = push.subdivision;
  float h = 1.0 / float(n);
  // Row i, column j: an upright triangle, and beside it an inverted one where the row has room.
  for (uint i = 0u; i < n; ++i) {
    for (uint j = 0u; i + j < n; ++j) {
      for (uint inverted = 0u; inverted < (i + j + 1u < n ? 2u : 1u); ++inverted) {
        float u = h * (float(i) + (inverted == 1u ? 2.0 : 1.0) / 3.0);
        float v = h * (float(j) + (inverted == 1u ? 2.0 : 1.0) / 3.0);
        float share = directional ? lit_share(face, u, v) : share_at(lamp, a + u * ab + v * ac, normal);
        quarter[quarter_of(u, v)] += share;
      }
    }
  }
  return weight * quarter;
}

// What of an environment enters a face, over its power: where facets lean, by their side of it as much more or less.
vec3 environment_share(LightShape shape, Refraction body, vec3 normal, Leaning leaning, uint hidden, uint face) {
  vec3 all = environment_at(shape, ENVIRONMENT_ENTERING + body.entering, normal), more = vec3(1);
  if (leaning.cosine != 1.0) {
    vec3 leant = environment_at(shape, ENVIRONMENT_ENTERING + body.entering, facet_normal(leaning));
    more = min(leant / max(all, vec3(1e-30)), vec3(2));
  }
  if (uvec2(push.hidden) == uvec2(0)) return push.sky.at[face] * more * all;
  return more * max(all - push.hidden.at[hidden], vec3(0));
}

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.face_count) return;
  uvec3 face = push.faces.at[f];
  vec3 a = push.vertices.at[face.x];
  vec3 ab = push.vertices.at[face.y] - a;
  vec3 ac = push.vertices.at[face.z] - a;
  vec3 doubled = cross(ab, ac);
  vec3 normal = doubled / max(length(doubled), 1e-30);  // none of a face without area

  Refraction body = refraction_behind(push.face_kinds, f);
  Leaning leaning = leaning_of(push.face_kinds, f, normal, ab, ac);
  vec3 q = vec3(0);
  uint beam = 0u;  // of the light
  uint environment = 0u;
  vec4 quarter = vec4(0);
  for (uint i = 0u; i < push.light_count; ++i) {
    LightRecord light = push.lights.at[i];
    if (light.kind == LIGHT_AMBIENT) {
      float share = push.sky.at[f] * body.transmitted;
      push.beam_q.at[beam + f] = share;
      q += share * light.power;
      beam += BEAM_FACE * push.face_count;
      continue;
    }
    Lamp lamp = Lamp(light, no_shape(), 0u, 0.0, body.surface, leaning);
    if (SHAPED) {
      lamp.shape = push.shapes.at[i];
      lamp.width = sqrt(0.5 * length(cross(ab, ac))) / float(push.subdivision);
    }
    if (SHAPED && light.kind == LIGHT_ENVIRONMENT) {
      vec3 share = environment_share(lamp.shape, body, normal, leaning, environment++ * push.face_count + f, f);
      for (uint c = 0u; c < 3u; ++c) push.beam_q.at[beam + BEAM_RGB * f + c] = share[c] * light.power[c];
      q += share * light.power;
      beam += BEAM_RGB * push.face_count;
      continue;
    }
    if (SHAPED && light.kind == LIGHT_PROJECTOR) {
      for (lamp.channel = 0u; lamp.channel < 3u; ++lamp.channel) {
        vec4 image = quarters_of(lamp, a, ab, ac, normal);
        uint at = beam + BEAM_RGB_QUARTERS * f + lamp.channel;
        for (uint k = 0u; k < FACE_QUARTERS; ++k) push.beam_q.at[at + 3u * k] = image[k];
        q[lamp.channel] += dot(image, vec4(0.25)) * light.power[lamp.channel];
      }
      beam += BEAM_RGB_QUARTERS * push.face_count;
      continue;
    }
    quarter += quarters_of(lamp, a, ab, ac, normal);
    if (lamp.shape.more_follow == 1u) continue;
    for (uint k = 0u; k < FACE_QUARTERS; ++k) push.beam_q.at[beam + FACE_QUARTERS * f + k] = quarter[k];
    q += dot(quarter, vec4(0.25)) * light.power;
    quarter = vec4(0);
    beam += BEAM_QUARTERS * push.face_count;
  }
  push.q.at[f] = q;
}
