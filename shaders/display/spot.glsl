// What is seen of the surface in a pixel, triangle by triangle (visibility buffer, Burns and Hunt 2013): shaded once for
// all samples of the pixel that show the triangle. The shader that includes it includes display/pixel.glsl first, and
// defines
//   SCENE  the SurfaceScene, e.g. push.scene.at[0]
#ifndef QUADGRAPH_SPOT_GLSL
#define QUADGRAPH_SPOT_GLSL

#include "display/specular.glsl"
#include "display/shading_normal.glsl"

// Part of a display triangle. `roughness`, `surface`, `evenly` and `coat_evenly` become those of the last that was
// made.
struct Spot {
  uvec3 vertices;  // of the display mesh
  vec3 l;          // barycentric coordinates of its middle in the triangle
  vec3 position;   // mm
  vec3 normal;     // unit, by which it is shaded
  vec3 specular;   // W/(mm^2 sr)
  float share;     // of the pixel
  float even_transmittance;  // what passes of even light within, over that of all directions: Lambertian radiance
};

// Samples of a pixel, as bits, that show anything; and those that show what sample k does.
uint covered_samples(uvec4 seen) {
  uint mask = 0u;
  for (uint k = 0u; k < 4u; ++k) mask |= seen[k] != 0u ? 1u << k : 0u;
  return mask;
}
uint alike(uvec4 seen, uint k) {
  uint mask = 0u;
  for (uint other = 0u; other < 4u; ++other) mask |= seen[other] == seen[k] ? 1u << other : 0u;
  return mask;
}

// What the samples of a pixel show.
struct SeenPixel {
  uvec4 samples;  // 1 + the display triangle, 0: none
  float alpha;    // share of the pixel that the body covers
  float scale;    // that over the share of the samples that show it
};

// Where the silhouette may cross the pixel, more places than its samples tell what is covered. Where these show
// nothing, all of them stand for a triangle that covers some of it.
SeenPixel seen_in(Pixel pixel) {
  SeenPixel seen;
  for (uint k = 0u; k < 4u; ++k) seen.samples[k] = push.seen.at[sample_of(pixel, k)];
  seen.alpha = 0.25 * float(bitCount(covered_samples(seen.samples)));
  seen.scale = 1.0;
  uint word = pixel.inside.y * silhouette_words(push.tile.width) + pixel.inside.x / 32u;
  if ((push.marked.at[word] >> pixel.inside.x % 32u & 1u) == 0u) return seen;
  PixelCoverage found = push.coverage.at[pixel.inside.y * push.tile.width + pixel.inside.x];
  if (covered_samples(seen.samples) == 0u) seen.samples = uvec4(found.triangle);
  int places = 0;
  for (uint k = 0u; k < COVERAGE_WORDS; ++k) places += bitCount(found.covered[k]);
  seen.alpha = float(places) / float(COVERAGE_PLACES);
  if (seen.alpha == 0.0) seen.samples = uvec4(0);
  seen.scale = 4.0 * seen.alpha / max(float(bitCount(covered_samples(seen.samples))), 1.0);
  return seen;
}

// Of the middle of some samples of a pixel: x and y in clip space after division.
vec2 middle_of(Pixel pixel, uint samples) {
  vec2 sum = vec2(0);
  float count = 0.0;
  for (uint k = 0u; k < 4u; ++k) {
    float taken = float(samples >> k & 1u);
    sum += taken * vec2(0.25 + 0.5 * float(k & 1u), 0.25 + 0.5 * float(k >> 1u));
    count += taken;
  }
  vec2 size = vec2(float(push.tile.picture_width), float(push.tile.picture_height));
  vec2 corner = vec2(float(pixel.index % push.tile.picture_width), float(pixel.index / push.tile.picture_width));
  vec2 at = 2.0 * (corner + sum / count) / size - 1.0;
  return vec2(at.x, -at.y);
}

vec3 clip_of(uint vertex) {
  vec4 clip = SCENE.clip_from_offset * vec4(SCENE.vertices.at[vertex] - SCENE.origin, 1.0);
  return vec3(clip.x, clip.y, clip.w);
}

float crossed(vec2 a, vec2 b) {
  return a.x * b.y - a.y * b.x;
}

// Barycentric coordinates, in perspective, of what a triangle's plane shows at a place in clip space; columns: x, y, w
// of its corners in clip space. Corners are taken from the place first, where little is lost to rounding.
vec3 weights_at(mat3 corners, vec2 place) {
  vec2 a = vec2(corners[0].x, corners[0].y) - corners[0].z * place;
  vec2 b = vec2(corners[1].x, corners[1].y) - corners[1].z * place;
  vec2 c = vec2(corners[2].x, corners[2].y) - corners[2].z * place;
  vec3 area = vec3(crossed(b, c), crossed(c, a), crossed(a, b));
  float sum = area.x + area.y + area.z;
  return sum == 0.0 ? vec3(1.0 / 3.0) : area / sum;
}

// Weights of what lies within; the edges were rounded to a fraction of a pixel when samples were drawn. Not on an edge
// itself: on which side of it a ray then begins, a last bit would say.
vec3 inside_triangle(vec3 l) {
  l = max(l, vec3(1e-3));
  return l / (l.x + l.y + l.z);
}

// A value at weights l, of three.
vec3 weighed(vec3 l, vec3 a, vec3 b, vec3 c) {
  return l.x * a + l.y * b + l.z * c;
}
vec3 positions_weighed(uvec3 at, vec3 l) {
  return weighed(l, SCENE.vertices.at[at.x], SCENE.vertices.at[at.y], SCENE.vertices.at[at.z]);
}
vec3 roughness_place(uvec3 at, vec3 l) {
  return weighed(l, SCENE.roughness_map.rest.at[at.x], SCENE.roughness_map.rest.at[at.y],
                 SCENE.roughness_map.rest.at[at.z]);
}
vec3 normal_place(uvec3 at, vec3 l) {
  return weighed(l, SCENE.normal_map.rest.at[at.x], SCENE.normal_map.rest.at[at.y], SCENE.normal_map.rest.at[at.z]);
}

// Makes `roughness` that of a point, and returns the normal by which it is shaded, unit: n, as maps lean it. `right`
// and `below`: barycentric coordinates a sample away, as pictures of several frames are as sharp as that.
vec3 mapped(uvec3 at, vec3 l, vec3 right, vec3 below, vec3 n) {
  if (has_roughness_map()) {
    vec3 rest = roughness_place(at, l);
    place_roughness(rest, roughness_place(at, right) - rest, roughness_place(at, below) - rest);
  }
  if (!has_normal_map()) return n;
  vec3 shape = normal_place(at, l), position = positions_weighed(at, l);
  return mapped_normal(n, shape, normal_place(at, right) - shape, normal_place(at, below) - shape,
                       positions_weighed(at, right) - position, positions_weighed(at, below) - position);
}

// What some samples of a pixel show of one display triangle.
Spot spot_of(Pixel pixel, uint triangle, uint samples) {
  Spot spot;
  spot.share = 0.25 * float(bitCount(samples));
  uvec3 at = uvec3(SCENE.triangles.at[3u * triangle], SCENE.triangles.at[3u * triangle + 1u],
                   SCENE.triangles.at[3u * triangle + 2u]);
  spot.vertices = at;
  mat3 corners = mat3(clip_of(at.x), clip_of(at.y), clip_of(at.z));
  vec2 place = middle_of(pixel, samples);
  spot.l = inside_triangle(weights_at(corners, place));
  spot.position = positions_weighed(at, spot.l);
  vec3 n = normalize(weighed(spot.l, SCENE.normals.at[at.x], SCENE.normals.at[at.y], SCENE.normals.at[at.z]));
  roughness = SCENE.roughness;
  if (has_roughness_map() || has_normal_map()) {
    vec3 right = weights_at(corners, place + vec2(1.0 / float(push.tile.picture_width), 0.0));
    vec3 below = weights_at(corners, place - vec2(0.0, 1.0 / float(push.tile.picture_height)));
    n = mapped(at, spot.l, right, below, n);
  }
  vec3 first = SCENE.vertices.at[at.x];
  vec3 across = cross(SCENE.vertices.at[at.y] - first, SCENE.vertices.at[at.z] - first);
  vec3 v = towards_eye(SCENE.eye, spot.position);
  spot.normal = seen_normal(n, across, v);
  Refraction body = refraction_behind(SCENE.face_kinds, SCENE.face.at[at.x]);
  surface = body.surface;
  float cosine = clamp(dot(spot.normal, v), 0.0, 1.0);
  evenly = rough_reflectance(body, cosine, roughness);
  coat_evenly = coat_reflectance(body, cosine);
  spot.even_transmittance = surface_transmittance(cosine, surface) / body.radiance_norm;
  float sky = dot(spot.l, vec3(SCENE.sky.at[SCENE.face.at[at.x]], SCENE.sky.at[SCENE.face.at[at.y]],
                               SCENE.sky.at[SCENE.face.at[at.z]]));
  spot.specular = specular_radiance(spot.position, spot.normal, v, sky);
  return spot;
}

#endif
