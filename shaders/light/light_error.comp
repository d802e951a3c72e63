#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/lights.glsl"
#include "light/shaped.glsl"
#include "material/fresnel.glsl"
#include "transport/entering_rays.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// How far q of every outside face is from what rays find, twice, by samples that share nothing: the mean of a product of
// the two is a square without their noise. Light from all around, which a correction takes in by rays, is off by the
// noise of those.
struct LightErrorPush {
  Vec3s vertices;  // mm
  Uvec3s faces;
  Uints face_kinds;
  Floats beam_q;  // as of IrradiancePush
  Floats sky;     // per face: share of all directions outside in which no other part of the body is
  Beams beams;    // in the order of the lights that make them up
  LightRecords lights;
  LightShapes shapes;  // per light
  ShadowViews views;
  TreeRef tree;
  Vec3s difference;  // W/mm^2, per sample and face; written by the first turn, added to by the others
  uint light_count;
  uint rays;  // of light from all around, a face
  uint turn;  // below LIGHT_TURNS: of the points of a sample, one invocation per sample and face; then the rest, one per face
  float sky_share;  // of the noise of light from all around, what counts
};
layout(push_constant, scalar) uniform Block { LightErrorPush push; };
#define ENTERED push
#include "light/entering.glsl"
#define TREE push.tree
#define TREE_BODY push
#include "exchange/face_tree.glsl"
#include "source/beam_light.glsl"

// Points on a face in each turn of a sample, rays from them, and places that are looked up in the maps for each of these.
// Of many lights fewer: each is the less of all. In turns, because a processor's driver for Vulkan leaves all loops of an
// invocation after 65535 rounds together.
const uint MOST_POINTS = 4u, POINTS_OF_ALL = 16u;
const uint PLACES = 4u;

struct Face {
  uint number;
  mat3 corners;
  vec3 normal;
  float width;  // of a sample of it, mm
  OpticalSurface surface;
  Leaning leaning;
};

Face face_of(uint number) {
  uvec3 ids = push.faces.at[number];
  vec3 a = push.vertices.at[ids.x], b = push.vertices.at[ids.y], c = push.vertices.at[ids.z];
  vec3 doubled = cross(b - a, c - a);
  float twice = length(doubled);
  vec3 normal = doubled / max(twice, 1e-30);
  return Face(number, mat3(a, b, c), normal, sqrt(0.5 * twice / float(FACE_QUARTERS)),
              surface_of(push.face_kinds, number), leaning_of(push.face_kinds, number, normal, b - a, c - a));
}

bool is_hidden(uint face, vec3 point, vec3 towards, float reach) {
  return meets_any(line_along(point, towards), face, reach);
}

// What a light in one place would bring to a point if nothing hid it, W/mm^2 that enter.
vec3 unhidden(Lamp lamp, vec3 point, vec3 normal) {
  vec3 share;
  uint channels = channels_of(lamp.light);
  for (lamp.channel = 0u; lamp.channel < channels; ++lamp.channel) share[lamp.channel] = share_from(lamp, point, normal);
  return (channels == 1u ? vec3(share.x) : share) * lamp.light.power;
}

// Number i of the lights, which may be several records; then i is the last of these.
Lamp lamp_of(inout uint i, Face face) {
  Lamp lamp = Lamp(push.lights.at[i], no_shape(), 0u, face.width, face.surface, face.leaning);
  if (!SHAPED) return lamp;
  lamp.shape = push.shapes.at[i];
  while (push.shapes.at[i].more_follow == 1u) ++i;
  return lamp;
}

bool has_direction(LightRecord light) {
  return light.kind != LIGHT_AMBIENT && light.kind != LIGHT_ENVIRONMENT;
}

// A rectangle instead of its first patch: a place in one of 4 x 4 equal parts of it, which points take in turn.
void place_on(Beam rectangle, uint k, inout Lamp lamp, inout uint state) {
  uint row = k / 4u % 4u;
  vec2 part = vec2((k + row) % 4u, row);
  part.x += uniform_number(state);
  part.y += uniform_number(state);
  vec2 place = 0.25 * part - 0.5;
  lamp.light.towards_or_at = rectangle.way.travel_or_from + place.x * rectangle.way.u + place.y * rectangle.way.v;
  lamp.shape.share = 1.0;
}

// What is wrong with the maps at a point: of one light, drawn by what it brings, what is hidden of all. Rectangles, which
// have maps of some of their places alone, come with all their light. k: number of the point in its sample.
vec3 unlike_maps(Face face, vec3 point, uint k, inout uint state) {
  Lamp drawn = Lamp(push.lights.at[0], no_shape(), 0u, 0.0, face.surface, face.leaning);
  vec3 light = vec3(0);
  float all = 0.0, chosen = 1.0;
  uint beam = 0u;
  for (uint i = 0u; i < push.light_count; ++i) {
    Lamp lamp = lamp_of(i, face);
    uint own = beam++;
    if (!has_direction(lamp.light)) continue;
    if (SHAPED && lamp.light.kind == LIGHT_PATCH) place_on(push.beams.at[own], k, lamp, state);
    vec3 brings = unhidden(lamp, point, face.normal);
    float weight = brings.x + brings.y + brings.z;
    all += weight;
    if (uniform_number(state) * all < weight) {
      drawn = lamp;
      light = brings;
      chosen = weight;
    }
  }
  if (all == 0.0) return vec3(0);
  float reach = drawn.light.kind == LIGHT_DIRECTIONAL ? FAR : distance(drawn.light.towards_or_at, point);
  vec3 towards = incident_light(drawn.light, drawn.shape, point).direction;
  float lit = is_hidden(face.number, point, towards, reach) ? 0.0 : 1.0;
  if (drawn.light.kind != LIGHT_PATCH) lit -= light_visibility(drawn.light, push.views, point, face.normal, 0);
  return lit * all / chosen * light;
}

// What arrives at a point by the maps, of all but rectangles.
vec3 by_maps(Face face, vec3 point) {
  vec3 sum = vec3(0);
  for (uint i = 0u; i < push.light_count; ++i) {
    Lamp lamp = lamp_of(i, face);
    if (!has_direction(lamp.light) || lamp.light.kind == LIGHT_PATCH) continue;
    vec3 light = unhidden(lamp, point, face.normal);
    if (light != vec3(0)) sum += light * light_visibility(lamp.light, push.views, point, face.normal, 0);
  }
  return sum;
}

// One turn's part of the mean over the face: the maps' own, at many places, and what rays find else, at some of them.
// number: of the sample, among all of the surface.
vec3 arriving(Face face, uint number) {
  uint lights = 0u;
  for (uint i = 0u; i < push.light_count; ++i) {
    if (!SHAPED || push.shapes.at[i].more_follow == 0u) ++lights;
  }
  uint points = clamp(POINTS_OF_ALL / max(lights, 1u), 1u, MOST_POINTS), all = LIGHT_TURNS * points;
  uint state = hash(LIGHT_TURNS * number + push.turn);
  vec3 mapped = vec3(0), unlike = vec3(0);
  for (uint j = 0u; j < PLACES * points; ++j) {
    uint k = push.turn * PLACES * points + j;
    vec3 point = face.corners * spread_over_quarter(PLACES * all * number + k, k % FACE_QUARTERS);
    mapped += by_maps(face, point);
  }
  for (uint j = 0u; j < points; ++j) {
    uint k = push.turn * points + j;
    vec3 point = face.corners * spread_over_quarter(PLACES * all * number + k, k % FACE_QUARTERS);
    unlike += unlike_maps(face, point, k, state);
  }
  return mapped / float(PLACES * all) + unlike / float(all);
}

// The noise of the rays of transport_walk.comp: half the difference between what those of even and of odd numbers let in;
// and what comes out of that, which differs from ray to ray by so much of it, with the depth that its direction takes it
// to. That share is chosen by what ten times the rays change (docs/accuracy.md, "The light").
const float RESPONSE_SPREAD = 0.3;

vec3 noise_of(Beam beam, Face face) {
  vec3 sum = vec3(0);
  for (uint ray = 0u; ray < push.rays; ++ray) {
    uint number = push.rays * face.number + ray, state = hash(face.number ^ hash(ray));
    vec3 along = face.corners[1] - face.corners[0];
    SkyRay drawn = drawn_from_sky(beam, number, face.normal, face.leaning, along, face.surface, state);
    if (drawn.let_in == vec3(0)) continue;
    vec3 point = face.corners * spread_over_face(number);
    if (push.sky.at[face.number] < 1.0 && is_hidden(face.number, point, drawn.towards, FAR)) continue;
    float counts = ray % 2u == 0u ? 1.0 : -1.0;
    counts += uniform_number(state) < 0.5 ? RESPONSE_SPREAD : -RESPONSE_SPREAD;
    sum += counts * drawn.let_in;
  }
  return sum / float(push.rays);
}

// Less the light that has been found for the face; with the noise of what comes from all around.
vec3 rest(Face face) {
  vec3 sum = vec3(0);
  uint beam = 0u;
  for (uint i = 0u; i < push.light_count; ++i) {
    if (SHAPED && push.shapes.at[i].more_follow == 1u) continue;
    Beam own = push.beams.at[beam++];
    if (is_sky(own)) {
      sum += push.sky_share * noise_of(own, face);
      continue;
    }
    for (uint k = 0u; k < FACE_QUARTERS; ++k) {
      sum -= 0.25 * beam_light(own, push.beam_q, faces_in(push.face_kinds), face.number, k);
    }
  }
  return sum;
}

void main() {
  uint faces = faces_in(push.face_kinds);
  uint i = gl_GlobalInvocationID.x, f = i % faces;
  if (push.turn < LIGHT_TURNS) {
    if (i >= LIGHT_SAMPLES * faces) return;
    vec3 found = arriving(face_of(f), LIGHT_SAMPLES * f + i / faces);
    push.difference.at[i] = push.turn == 0u ? found : push.difference.at[i] + found;
    return;
  }
  if (i >= faces) return;
  vec3 more = rest(face_of(f));
  for (uint k = 0u; k < LIGHT_SAMPLES; ++k) push.difference.at[k * faces + f] += more;
}
